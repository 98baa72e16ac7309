#include "shared/image/exr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>

#include "shared/file/durable_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

// Values that a careless conversion would change.
const std::vector<float> kAwkward{0.f,
                                  -0.f,
                                  1.f,
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  std::bit_cast<float>(0x7fc12345u),
                                  std::bit_cast<float>(0xffffffffu),
                                  std::numeric_limits<float>::denorm_min(),
                                  -1e-40f,
                                  std::numeric_limits<float>::max(),
                                  65504.f * 2,
                                  1e-30f};

FloatImage awkwardImage(uint32_t width, uint32_t height) {
    FloatImage image{width, height, {"A", "R", "layer.x"}, {}};
    for (size_t c = 0; c < 3; ++c) {
        auto& plane = image.planes.emplace_back(image.pixelCount());
        for (size_t i = 0; i < plane.size(); ++i) plane[i] = kAwkward[(i + 5 * c) % kAwkward.size()];
    }
    return image;
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
        return std::bit_cast<uint32_t>(x) == std::bit_cast<uint32_t>(y);
    });
}

TEST(Exr, KeepsEveryBitAndEveryAttribute) {
    const TemporaryFolder folder;
    const FloatImage image = awkwardImage(37, 21);
    const ImageAttributes attributes{{"job", "j-1"}, {"settings", "{\"seed\":1}"}, {"empty", ""}};
    writeExr(folder / "a.exr", image, attributes);

    const FloatImage read = readExr(folder / "a.exr");
    EXPECT_EQ(read.width, 37u);
    EXPECT_EQ(read.height, 21u);
    EXPECT_EQ(read.channels, image.channels);
    for (size_t c = 0; c < 3; ++c)
        EXPECT_TRUE(sameBits(read.planes[c], image.planes[c])) << image.channels[c];
    EXPECT_EQ(readExrAttributes(folder / "a.exr"), attributes);

    const auto bytes = readWhole(folder / "a.exr");
    EXPECT_TRUE(sameBits(readExr(bytes, "upload").plane("layer.x"), image.planes[2]));
}

// Of one to four bytes a character, and of lengths around those where parts end.
TEST(Exr, SplitsLongAttributesBetweenCharactersAndJoinsThem) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    ImageAttributes attributes{{"note.007", "a name of its own"}};
    for (const size_t length : {0u, 249u, 250u, 251u, 499u, 500u, 501u, 1000u, 70'000u, 251'000u}) {
        std::string& text = attributes["t" + std::to_string(length)];
        constexpr std::array characters{"a", "é", "€", "🎬"};
        while (text.size() + 4 <= length) text += characters[random() % 4];
        text.resize(length, '-');
    }
    writeExr(folder / "a.exr", {1, 1, {"Y"}, {{1}}}, attributes);
    EXPECT_EQ(readExrAttributes(folder / "a.exr"), attributes);
    size_t entries = 0;
    for (const auto& [name, value] : readExrMetadata(folder / "a.exr")) {
        EXPECT_LE(value.size(), 250u) << name;
        EXPECT_TRUE(value.empty() || (value[0] & 0xc0) != 0x80) << name << " begins within a character";
        ++entries;
    }
    EXPECT_GT(entries, 251'000u / 250);
}

FilmTile tileOf(const ImageSpec& image, uint32_t index) {
    FilmTile tile(TileGrid(image).rect(index));
    for (uint32_t y = 0; y < tile.rect.height; ++y)
        for (uint32_t x = 0; x < tile.rect.width; ++x) {
            FilmPixel& p = tile.pixels[y * tile.rect.width + x];
            const double fx = tile.rect.x + x, fy = tile.rect.y + y;
            p.mean = {fx, fy, 1.0 / 3};
            p.m2 = {6 * fx, 6 * fy, 0};
            p.count = 3, p.alpha = 0.5, p.depth = 7;
            p.albedo = {0.1, 0.2, 0.3}, p.normal = {0, -1, 0.25};
        }
    return tile;
}

TEST(FrameExr, PutsFurtherChannelsBesideAndRanksIdsByCoverage) {
    const TemporaryFolder folder;
    const ImageSpec image{.width = 20, .height = 9, .tileSize = 16};
    const FilmLayout layout{.uv = true, .cryptomatte = true};
    const auto tileWith = [&](uint32_t index) {
        FilmTile tile(TileGrid(image).rect(index), layout);
        for (size_t i = 0; i < tile.pixels.size(); ++i) {
            tile.pixels[i].count = 8, tile.pixels[i].alpha = 0.25;
            const auto extra = tile.extraOf(i);
            extra[0] = static_cast<double>(tile.rect.x + i % tile.rect.width);
            // Ids 5, 6 and 7 with 1, 4 and 3 of 8 samples.
            for (size_t k = 0; k < 3; ++k) {
                extra[2 + 2 * k] = 5 + static_cast<double>(k);
                extra[3 + 2 * k] = std::array{1., 4., 3.}[k];
            }
        }
        return tile;
    };
    writeFrameExr(folder / "f.exr", image, tileWith, {},
                  {layout, {{"cryptomatte/3ae39a5/name", "CryptoObject"}}});
    const FloatImage read = readExr(folder / "f.exr");
    for (size_t i = 0; i < read.pixelCount(); ++i) {
        ASSERT_EQ(read.plane("uv.U")[i], static_cast<float>(i % 20));
        ASSERT_EQ(read.plane("uv.A")[i], read.plane("A")[i]);
        const float wanted[] = {6, 0.5f, 7, 0.375f, 5, 0.125f, 0, 0};
        for (size_t c = 0; c < 8; ++c)
            ASSERT_EQ(read.plane(std::string("CryptoObject0") + "01"[c / 4] + "." + "RGBA"[c % 4])[i],
                      wanted[c])
                << c;
        ASSERT_EQ(read.plane("CryptoMaterial00.R")[i], 0);
    }
    EXPECT_EQ(readExrMetadata(folder / "f.exr").at("cryptomatte/3ae39a5/name"), "CryptoObject");
    EXPECT_THROW(writeFrameExr(folder / "g.exr", image, tileWith, {}), Error) << "tiles of another layout";
}

TEST(FrameExr, PutsEveryPixelOfEveryTileInItsPlace) {
    const TemporaryFolder folder;
    const ImageSpec image{.width = 83, .height = 45, .tileSize = 16};
    std::vector<uint32_t> asked;
    writeFrameExr(folder / "f.exr", image,
                  [&](uint32_t t) {
                      asked.push_back(t);
                      return tileOf(image, t);
                  },
                  {{"state", "partial"}});

    const FloatImage read = readExr(folder / "f.exr");
    ASSERT_EQ(read.width, 83u);
    ASSERT_EQ(read.height, 45u);
    for (uint32_t y = 0; y < 45; ++y)
        for (uint32_t x = 0; x < 83; ++x) {
            const size_t i = y * 83 + x;
            ASSERT_EQ(read.plane("R")[i], static_cast<float>(x));
            ASSERT_EQ(read.plane("G")[i], static_cast<float>(y));
            ASSERT_EQ(read.plane("variance.R")[i], static_cast<float>(x));  // M2 / (3 · 2)
            ASSERT_EQ(read.plane("variance.G")[i], static_cast<float>(y));
        }
    EXPECT_EQ(read.plane("B")[0], static_cast<float>(1.0 / 3));
    EXPECT_EQ(read.plane("A")[5], 0.5f);
    EXPECT_EQ(read.plane("samples.X")[5], 3.f);
    EXPECT_EQ(read.plane("Z")[5], 7.f);
    EXPECT_EQ(read.plane("albedo.G")[5], 0.2f);
    EXPECT_EQ(read.plane("normal.Y")[5], -1.f);
    EXPECT_EQ(read.channels.size(), 15u);
    EXPECT_EQ(readExrAttributes(folder / "f.exr").at("state"), "partial");

    std::vector<uint32_t> once(TileGrid(image).count());
    std::iota(once.begin(), once.end(), 0u);
    EXPECT_EQ(asked, once);
}

TEST(FrameExr, DoesNotDependOnTheTileSize) {
    const TemporaryFolder folder;
    for (const uint32_t size : {8u, 64u, 128u}) {
        const ImageSpec image{.width = 83, .height = 45, .tileSize = size};
        writeFrameExr(folder / std::to_string(size), image, [&](uint32_t t) { return tileOf(image, t); }, {});
    }
    EXPECT_EQ(readWhole(folder / "8"), readWhole(folder / "128"));
    EXPECT_EQ(readWhole(folder / "64"), readWhole(folder / "128"));
}

TEST(FrameExr, LeavesNothingWhenATileCannotBeHad) {
    const TemporaryFolder folder;
    const ImageSpec image{.width = 64, .height = 64, .tileSize = 16};
    const auto failing = [&](uint32_t t) {
        if (t == 9) throw Error(ErrorCode::notFound, "tile 9 is lost");
        return tileOf(image, t);
    };
    EXPECT_STREQ(errorOf([&] { writeFrameExr(folder / "f.exr", image, failing, {}); }).what(),
                 "tile 9 is lost");
    EXPECT_TRUE(fs::is_empty(folder.path()));
    EXPECT_EQ(
        codeOf([&] {
            writeFrameExr(folder / "f.exr", image, [&](uint32_t) { return FilmTile(Rect{0, 0, 1, 1}); }, {});
        }),
        ErrorCode::internal);
    EXPECT_EQ(codeOf([&] {
                  writeFrameExr(folder / "no/f.exr", image, [&](uint32_t t) { return tileOf(image, t); }, {});
              }),
              ErrorCode::notFound);
}

void expectRefused(std::span<const std::byte> bytes, const std::string& what) {
    try {
        readExr(bytes, "hostile.exr");
        ADD_FAILURE() << what << " was read";
    } catch (const Error& e) {
        EXPECT_EQ(e.code, ErrorCode::invalidArgument) << what;
        EXPECT_THAT(e.what(), HasSubstr("hostile.exr")) << what;
    }
}

std::vector<std::byte> someExr() {
    const TemporaryFolder folder;
    writeExr(folder / "a.exr", awkwardImage(64, 48), {{"job", "1"}});
    return readWhole(folder / "a.exr");
}

TEST(HostileExr, TruncatedAnywhereIsAnErrorThatNamesTheFile) {
    const auto whole = someExr();
    for (size_t size = 0; size < whole.size(); size += 100)
        expectRefused(std::span(whole).first(size), "cut to " + std::to_string(size));
    expectRefused(std::span(whole).first(whole.size() - 1), "cut by a byte");
}

TEST(HostileExr, WithSpoiltBytesIsReadOrRefusedButDoesNotCrash) {
    const auto whole = someExr();
    std::mt19937 random(7);
    for (int round = 0; round < 3000; ++round) {
        auto spoilt = whole;
        // Most in the header, where lengths and windows stand.
        const size_t reach = round % 3 ? std::min<size_t>(spoilt.size(), 600) : spoilt.size();
        for (int i = 0; i < 1 + round % 4; ++i) spoilt[random() % reach] = static_cast<std::byte>(random());
        try {
            const FloatImage image = readExr(spoilt, "spoilt");
            EXPECT_EQ(image.planes.size(), image.channels.size());
        } catch (const Error& e) {
            EXPECT_EQ(e.code, ErrorCode::invalidArgument);
        }
    }
}

TEST(HostileExr, ThatClaimsAHugeImageIsRefusedBeforeMemoryIsTaken) {
    auto bytes = someExr();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const int32_t huge = 60000;
    for (const char* window : {"dataWindow", "displayWindow"}) {
        const size_t value = text.find(window) + std::string_view(window).size() + 1 + 6 + 4;
        std::memcpy(bytes.data() + value + 8, &huge, 4);
        std::memcpy(bytes.data() + value + 12, &huge, 4);
    }
    expectRefused(bytes, "a huge window");
}

TEST(HostileExr, ThatClaimsAHugeAttributeInALaterPartIsRefusedBeforeMemoryIsTaken) {
    const ImageSpec image{16, 8, 8};
    const PassFilm film{0, {0, 0, 8, 8}, {0, 1}, std::vector<PassPixel>(64), {}};
    auto bytes = encodePassFilms(std::vector<PassFilm>(2, film), image, {});
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view attribute("screenWindowWidth\0float\0", 24);
    const size_t second = text.find(attribute, text.find(attribute) + 1);
    ASSERT_NE(second, text.npos);
    const int32_t huge = std::numeric_limits<int32_t>::max();
    std::memcpy(bytes.data() + second + attribute.size(), &huge, sizeof huge);
    expectRefused(bytes, "a huge attribute");
    EXPECT_THAT(errorOf([&] { readExr(bytes, "hostile.exr"); }).what(),
                HasSubstr("ends early, within an attribute"));
}

TEST(HostileExr, ThatClaimsAnEndlessWindowIsRefusedBeforeTablesAreMade) {
    auto bytes = someExr();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const size_t window = text.find("dataWindow") + std::string_view("dataWindow_box2i_size").size();
    const int32_t endless = 1'000'000'000;
    std::memcpy(bytes.data() + window + 3 * sizeof(int32_t), &endless, sizeof endless);
    EXPECT_THAT(errorOf([&] { readExr(bytes, "hostile.exr"); }).what(),
                HasSubstr("it claims 64x1000000001 pixels"));
}

TEST(HostileExr, ThatClaimsHugeTilesIsRefusedBeforeBuffersAreMade) {
    auto bytes = someExr();
    // Behind the magic number and the version, whose bit 9 says that there are tiles.
    bytes[5] |= std::byte{2};
    const std::string_view attribute("tiles\0tiledesc\0\x09\0\0\0\0\0\1\0\0\0\1\0\0", 28);
    const auto added = std::as_bytes(std::span(attribute));
    bytes.insert(bytes.begin() + 8, added.begin(), added.end());
    EXPECT_THAT(errorOf([&] { readExr(bytes, "hostile.exr"); }).what(),
                HasSubstr("cannot hold its tiles of 65536x65536"));
}

// OpenEXR reads some attributes by their contents and goes on where those end: found by image_fuzzer, which
// made it take a name for the size of the next attribute.
TEST(HostileExr, WhoseAttributesEndBeforeTheirSizeIsRefused) {
    const auto whole = someExr();
    const auto after = [&](std::string_view name) {
        const std::string_view text(reinterpret_cast<const char*>(whole.data()), whole.size());
        return text.find(name) + name.size();
    };
    auto bytes = whole;
    bytes[after(std::string_view("channels\0chlist\0", 16)) + 4] = std::byte{0};  // the first channel's name
    EXPECT_THAT(errorOf([&] { readExr(bytes, "hostile.exr"); }).what(),
                HasSubstr("its list of channels ends before the attribute does"));
    bytes = whole;
    const size_t window = after(std::string_view("displayWindow\0box2i\0", 20));
    bytes[window] = std::byte{20};
    EXPECT_THAT(errorOf([&] { readExr(bytes, "hostile.exr"); }).what(),
                HasSubstr("its attribute displayWindow of type box2i has 20 bytes, not 16"));
    for (const std::string_view attribute :
         {std::string_view("p\0preview\0\x0c\0\0\0\0\1\0\0\0\1\0\0abcd", 26),
          std::string_view("s\0stringvector\0\x08\0\0\0\xff\xff\xff\x7f....", 27)}) {
        bytes = whole;
        const auto added = std::as_bytes(std::span(attribute));
        bytes.insert(bytes.begin() + 8, added.begin(), added.end());
        expectRefused(bytes, "an attribute larger than its size");
    }
}

TEST(HostileExr, OtherFilesAreNamed) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.exr") << "no picture at all, but long enough to hold a header of some kind";
    EXPECT_THAT(errorOf([&] { readExr(folder / "a.exr"); }).what(), HasSubstr("a.exr"));
    EXPECT_EQ(codeOf([&] { readExr(folder / "absent.exr"); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { readExr(folder.path()); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { readExrAttributes(folder / "a.exr"); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
