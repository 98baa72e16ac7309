#include "shared/film/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "shared/film/film.h"
#include "shared/job/job.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

constexpr FilmLayout kAll{.lightPaths = true, .uv = true, .cryptomatte = true};
constexpr FilmLayout kMatte{.cryptomatte = true};
constexpr uint32_t kObjects = 2 * kMatteRanks;  // floats of a layer

TEST(FilmLayout, FollowsTheJob) {
    JobSpec job;
    EXPECT_EQ(filmLayoutOf(job), FilmLayout{});
    EXPECT_EQ(FilmLayout{}.floats(), 0u);
    job.output = {true, true, true};
    EXPECT_EQ(filmLayoutOf(job), kAll);
    EXPECT_EQ(kAll.floats(), 27u + 2 + 24);
    for (const FilmLayout& layout : FilmLayout::all()) EXPECT_EQ(layout.channels().size(), layout.floats());
    EXPECT_EQ(kMatte.channels()[4], "CryptoObject01.R");
    EXPECT_EQ(kMatte.channels()[23], "CryptoMaterial02.A");
}

// A pixel of `count` samples with these ids of objects; every mean is `mean`.
PassFilm passOf(uint32_t first, uint32_t count, float mean, const std::vector<std::pair<float, float>>& ids,
                const FilmLayout& layout = kAll) {
    PassFilm pass{.tile = 0, .rect = {0, 0, 1, 1}, .samples = {first, count}, .pixels = {PassPixel{}}};
    pass.pixels[0].count = static_cast<float>(count);
    pass.layout = layout;
    pass.extra.assign(layout.floats(), 0);
    std::fill_n(pass.extra.begin(), layout.means(), mean);
    for (size_t i = 0; i < ids.size(); ++i) {
        pass.extra[layout.means() + 2 * i] = ids[i].first;
        pass.extra[layout.means() + 2 * i + 1] = ids[i].second;
    }
    return pass;
}

TEST(FilmExtra, MeansAreThoseOfAllSamplesAndCountsAreSums) {
    FilmTile tile({0, 0, 1, 1}, kAll);
    tile.merge(passOf(0, 1, 8, {{2.f, 1.f}}));
    tile.merge(passOf(1, 1, 4, {{3.f, 1.f}}));
    tile.merge(passOf(2, 2, 1, {{3.f, 1.f}, {2.f, 1.f}}));
    for (uint32_t c = 0; c < kAll.means(); ++c) EXPECT_DOUBLE_EQ(tile.extra[c], (8 + 4 + 1 + 1) / 4.0);
    const auto ids = tile.extraOf(0).subspan(kAll.means(), 4);
    EXPECT_THAT(std::vector<double>(ids.begin(), ids.end()), testing::ElementsAre(2, 2, 3, 2));
}

TEST(FilmExtra, SamplesThatWereDroppedLeaveNoTrace) {
    FilmTile tile({0, 0, 1, 1}, kAll);
    tile.merge(passOf(0, 1, 8, {{2.f, 1.f}}));
    PassFilm dropped = passOf(1, 1, 0, {});
    dropped.pixels[0].count = 0;
    tile.merge(dropped);
    EXPECT_EQ(tile.extra[0], 8);
    EXPECT_EQ(tile.extra[kAll.means() + 1], 1);
}

TEST(FilmExtra, KeepsTheFirstIdsWhereThereAreMoreThanRanks) {
    FilmTile tile({0, 0, 1, 1}, kMatte);
    for (uint32_t i = 0; i < 8; ++i)
        tile.merge(passOf(i, 1, 0, {{1.f + static_cast<float>(i), 1.f}}, kMatte));
    tile.merge(passOf(8, 2, 0, {{7.f, 1.f}, {1.f, 1.f}}, kMatte));
    for (uint32_t k = 0; k < kMatteRanks; ++k) {
        EXPECT_EQ(tile.extra[2 * k], 1 + k);
        EXPECT_EQ(tile.extra[2 * k + 1], k == 0 ? 2 : 1);
    }
    EXPECT_EQ(tile.extra[kObjects], 0) << "the layer of materials is untouched";
}

std::string refusalOf(const PassFilm& pass, const FilmLayout& layout = kAll) {
    FilmTile tile({0, 0, 1, 1}, layout);
    const Error error = errorOf([&] { tile.merge(pass); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_EQ(tile.mergedSamples, 0u);
    return error.what();
}

TEST(HostileFilmExtra, IsRefusedWithTileAndFault) {
    EXPECT_THAT(
        refusalOf(passOf(0, 4, 0, {}, kMatte)),
        HasSubstr(
            "tile 0, samples 0+4: its additional channels are cryptomatte, but the job's are lightPaths"));
    PassFilm pass = passOf(0, 4, 0, {});
    pass.extra.pop_back();
    EXPECT_THAT(refusalOf(pass), HasSubstr("52 further values"));
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        EXPECT_THAT(refusalOf(passOf(0, 4, bad, {})),
                    HasSubstr("pixel (0, 0): a mean of the additional channels"));
        EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{bad, 1.f}})), HasSubstr("an id is not one"));
        EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{2.f, bad}})), HasSubstr("sample count"));
    }
    EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{0.f, 1.f}})), HasSubstr("an id is not one"));
    EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{1e-40f, 1.f}})), HasSubstr("an id is not one"));
    for (const float bad : {0.f, -1.f, 0.5f, 5.f})
        EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{2.f, bad}})), HasSubstr("sample count")) << bad;
    EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{2.f, 1.f}, {2.f, 1.f}})), HasSubstr("twice"));
    EXPECT_THAT(refusalOf(passOf(0, 4, 0, {{2.f, 3.f}, {3.f, 2.f}})), HasSubstr("more samples than it has"));
}

}  // namespace
}  // namespace tilefarm
