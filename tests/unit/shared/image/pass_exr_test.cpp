#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include <cstring>
#include <random>

#include "shared/file/durable_file.h"
#include "shared/image/exr.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

constexpr ImageSpec kImage{.width = 83, .height = 45, .tileSize = 32};

// Pixels of random bits: NaN of every kind, infinities, denormals.
std::vector<PassFilm> someFilms(const FilmLayout& layout = {}) {
    std::mt19937 random(3);
    std::vector<PassFilm> films;
    for (const auto& [tile, samples] :
         {std::pair{0u, SampleRange{0, 1}}, {5u, SampleRange{64, 64}}, {5u, SampleRange{0, 1}}}) {
        PassFilm& film = films.emplace_back(PassFilm{tile, TileGrid(kImage).rect(tile), samples, {}});
        film.pixels.resize(film.rect.area());
        std::vector<uint32_t> bits(film.pixels.size() * sizeof(PassPixel) / 4);
        for (uint32_t& word : bits) word = static_cast<uint32_t>(random());
        std::memcpy(static_cast<void*>(film.pixels.data()), bits.data(), bits.size() * 4);
        film.layout = layout;
        film.extra.resize(film.pixels.size() * layout.floats());
        for (float& value : film.extra) {
            const auto word = static_cast<uint32_t>(random());
            std::memcpy(&value, &word, sizeof word);
        }
    }
    return films;
}

const ImageAttributes kAttributes{{"device", "llvmpipe"},
                                  {"a rather long key that EXR calls a long name", "x"}};

void expectSame(const std::vector<PassFilm>& a, const std::vector<PassFilm>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].tile, b[i].tile);
        EXPECT_EQ(a[i].rect, b[i].rect);
        EXPECT_EQ(a[i].samples, b[i].samples);
        ASSERT_EQ(a[i].pixels.size(), b[i].pixels.size());
        EXPECT_EQ(std::memcmp(a[i].pixels.data(), b[i].pixels.data(), a[i].pixels.size() * sizeof(PassPixel)),
                  0);
        EXPECT_EQ(a[i].layout, b[i].layout);
        ASSERT_EQ(a[i].extra.size(), b[i].extra.size());
        const size_t bytes = a[i].extra.size() * sizeof(float);
        EXPECT_TRUE(bytes == 0 || std::memcmp(a[i].extra.data(), b[i].extra.data(), bytes) == 0);
    }
}

TEST(PassExr, KeepsEveryBit) {
    const auto films = someFilms();
    const auto bytes = encodePassFilms(films, kImage, kAttributes);
    expectSame(decodePassFilms(bytes), films);
    EXPECT_EQ(decodePassAttributes(bytes), kAttributes);
}

TEST(PassExr, KeepsEveryBitOfTheFurtherChannelsOfEveryLayout) {
    for (const FilmLayout& layout : FilmLayout::all()) {
        SCOPED_TRACE(layout.text());
        const auto films = someFilms(layout);
        expectSame(decodePassFilms(encodePassFilms(films, kImage, kAttributes)), films);
    }
}

TEST(HostilePassExr, WithFurtherChannelsThatAreSpoiltOrCutIsRefusedOrReadButDoesNotCrash) {
    const auto whole = encodePassFilms(someFilms(FilmLayout::all().back()), kImage, kAttributes);
    std::mt19937 random(12);
    for (int round = 0; round < 3000; ++round) {
        auto spoilt = whole;
        const size_t reach = round % 4 ? size_t{9000} : spoilt.size();
        for (int i = 0; i < 1 + round % 5; ++i) spoilt[random() % reach] = static_cast<std::byte>(random());
        if (round % 3 == 0) spoilt.resize(random() % spoilt.size());
        try {
            decodePassFilms(spoilt);
        } catch (const Error& e) {
            ASSERT_EQ(e.code, ErrorCode::unprocessable);
        }
    }
}

TEST(PassExr, CarriesTheFaultsOfEachPass) {
    auto films = someFilms();
    const Rect& r = films[1].rect;
    films[1].faults = {
        7, uint64_t{1} << 10, 5.5, 3, 0.25, 1u << 20, {{r.x + 3, r.y + 2, 65}, {r.x, r.y, 127}}};
    const auto read = decodePassFilms(encodePassFilms(films, kImage, kAttributes));
    for (size_t i = 0; i < films.size(); ++i) EXPECT_EQ(read[i].faults, films[i].faults) << i;
}

TEST(HostilePassExr, WithFaultsThatCannotBeIsRefused) {
    const auto refused = [](const PassFaults& faults) {
        auto films = someFilms();
        films[1].faults = faults;
        const auto bytes = encodePassFilms(films, kImage, kAttributes);
        return codeOf([&] { decodePassFilms(bytes); }) == ErrorCode::unprocessable;
    };
    const Rect r = someFilms()[1].rect;
    EXPECT_TRUE(refused({uint64_t{1} << 40, 0, 0, 0, 0, 0, {}}));
    EXPECT_TRUE(refused({0, 0, 0, uint64_t{1} << 40, 0, 0, {}}));
    EXPECT_TRUE(refused({0, 1, -1, 0, 0, 0, {}})) << "negative light";
    EXPECT_TRUE(refused({0, 0, 0, 1, std::numeric_limits<double>::quiet_NaN(), 0, {}}));
    EXPECT_TRUE(refused({0, 0, 0, 0, 0, 0, {{r.x + r.width, r.y, 64}}})) << "beside the tile";
    EXPECT_TRUE(refused({0, 0, 0, 0, 0, 0, {{r.x, r.y, 3}}})) << "of another pass";
    EXPECT_TRUE(refused({0, 0, 0, 0, 0, 0, std::vector<DroppedSample>(kMostDropped + 1, {r.x, r.y, 64})}));
}

TEST(PassExr, IsAnExrThatOpenExrReadsAlike) {
    const TemporaryFolder folder;
    const auto films = someFilms();
    writeDurably(folder / "u.exr", encodePassFilms(films, kImage, kAttributes));

    Imf::MultiPartInputFile exr((folder / "u.exr").c_str(), 0);
    ASSERT_EQ(exr.parts(), 3);
    EXPECT_EQ(readExrAttributes(folder / "u.exr"), kAttributes);
    for (int part = 0; part < 3; ++part) {
        const PassFilm& film = films[static_cast<size_t>(part)];
        const Imath::Box2i window = exr.header(part).dataWindow();
        EXPECT_EQ(window.min.x, static_cast<int>(film.rect.x));
        EXPECT_EQ(window.max.y, static_cast<int>(film.rect.y + film.rect.height - 1));
        std::vector<float> r(film.rect.area()), count(film.rect.area()), depth(film.rect.area());
        Imf::FrameBuffer buffer;
        buffer.insert("R", Imf::Slice::Make(Imf::FLOAT, r.data(), window));
        buffer.insert("samples", Imf::Slice::Make(Imf::FLOAT, count.data(), window));
        buffer.insert("Z", Imf::Slice::Make(Imf::FLOAT, depth.data(), window));
        Imf::InputPart input(exr, part);
        input.setFrameBuffer(buffer);
        input.readPixels(window.min.y, window.max.y);
        for (size_t i = 0; i < r.size(); ++i) {
            ASSERT_EQ(std::memcmp(&r[i], &film.pixels[i].mean[0], 4), 0);
            ASSERT_EQ(std::memcmp(&count[i], &film.pixels[i].count, 4), 0);
            ASSERT_EQ(std::memcmp(&depth[i], &film.pixels[i].depth, 4), 0);
        }
    }
}

TEST(PassExr, RefusesToWriteFilmsThatDoNotFit) {
    auto films = someFilms();
    EXPECT_EQ(codeOf([&] { encodePassFilms({}, kImage, {}); }), ErrorCode::internal);
    films[1].rect.x = 65;
    EXPECT_EQ(codeOf([&] { encodePassFilms(films, kImage, {}); }), ErrorCode::internal);
    films = someFilms();
    films[2].pixels.pop_back();
    EXPECT_EQ(codeOf([&] { encodePassFilms(films, kImage, {}); }), ErrorCode::internal);
}

std::string refusalOf(std::span<const std::byte> bytes) {
    const Error error = errorOf([&] { decodePassFilms(bytes); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    return error.what();
}

TEST(HostilePassExr, TruncatedAnywhereIsRefused) {
    const auto whole = encodePassFilms(someFilms(), kImage, kAttributes);
    for (size_t size = 0; size < whole.size(); size += size < 4000 ? 1 : 100)
        refusalOf(std::span(whole).first(size));
    refusalOf(std::span(whole).first(whole.size() - 1));
    auto longer = whole;
    longer.push_back(std::byte{0});
    EXPECT_THAT(refusalOf(longer), HasSubstr("bytes follow the headers"));
}

TEST(HostilePassExr, WithSpoiltBytesIsReadOrRefusedButDoesNotCrash) {
    const auto whole = encodePassFilms(someFilms(), kImage, kAttributes);
    std::mt19937 random(11);
    for (int round = 0; round < 20000; ++round) {
        auto spoilt = whole;
        const size_t reach = round % 4 ? size_t{5000} : spoilt.size();
        for (int i = 0; i < 1 + round % 5; ++i) spoilt[random() % reach] = static_cast<std::byte>(random());
        try {
            decodePassFilms(spoilt);
        } catch (const Error& e) {
            ASSERT_EQ(e.code, ErrorCode::unprocessable);
        }
    }
}

// The whole with `value` put where the attribute `name` of part `part` has its value, plus `offset`.
template <typename T>
std::vector<std::byte> patched(const char* name, const char* type, size_t part, T value, size_t offset = 0) {
    auto bytes = encodePassFilms(someFilms(), kImage, kAttributes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string key = std::string(name) + '\0' + type + '\0';
    size_t at = text.find(key);
    for (size_t p = 0; p < part; ++p) at = text.find(key, at + 1);
    std::memcpy(bytes.data() + at + key.size() + 4 + offset, &value, sizeof value);
    return bytes;
}

TEST(HostilePassExr, NamesThePartAndTheFault) {
    EXPECT_THAT(refusalOf(patched<uint8_t>("compression", "compression", 1, 3)),
                HasSubstr("part 1: it is compressed"));
    EXPECT_THAT(refusalOf(patched<char>("type", "string", 2, 't')),
                HasSubstr("part 2: it is no scanline image"));
    EXPECT_THAT(refusalOf(patched<char>("channels", "chlist", 0, 'X')), HasSubstr("part 0: its channels"));
    EXPECT_THAT(refusalOf(patched<int32_t>("dataWindow", "box2i", 1, -1)),
                HasSubstr("part 1: its data window"));
    EXPECT_THAT(refusalOf(patched<int32_t>("dataWindow", "box2i", 1, INT32_MAX, 8)),
                HasSubstr("part 1: its data window"));
    EXPECT_THAT(refusalOf(patched<int32_t>("dataWindow", "box2i", 2, 0)),
                HasSubstr("bytes follow the headers"));
    EXPECT_THAT(refusalOf(patched<int32_t>("displayWindow", "box2i", 0, INT32_MAX, 8)),
                HasSubstr("display window"));
    EXPECT_THAT(refusalOf(patched<int32_t>("tilefarm.pass.tile", "int", 0, -1)), HasSubstr("out of range"));
    EXPECT_THAT(refusalOf(patched<int32_t>("tilefarm.pass.count", "int", 0, 0)), HasSubstr("out of range"));
    EXPECT_THAT(refusalOf(patched<int32_t>("tilefarm.pass.count", "int", 0, kMaxPassSamples + 1)),
                HasSubstr("out of range"));
}

TEST(HostilePassExr, RefusesChunksThatRepeatOrStandOutside) {
    const auto whole = encodePassFilms(someFilms(), kImage, {});
    const auto films = someFilms();
    const size_t chunk = 12 + films[2].rect.width * sizeof(PassPixel);
    auto repeated = whole;
    std::memcpy(repeated.data() + whole.size() - chunk, whole.data() + whole.size() - 2 * chunk, chunk);
    EXPECT_THAT(refusalOf(repeated), HasSubstr("stands twice"));

    const auto spoil = [&](size_t field, uint32_t value) {
        auto bytes = whole;
        std::memcpy(bytes.data() + whole.size() - chunk + field, &value, 4);
        return refusalOf(bytes);
    };
    EXPECT_THAT(spoil(0, 3), HasSubstr("a chunk of part 3"));
    EXPECT_THAT(spoil(4, 1000), HasSubstr("outside"));
    EXPECT_THAT(spoil(8, 0), HasSubstr("bytes"));
}

}  // namespace
}  // namespace tilefarm
