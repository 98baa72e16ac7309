#include <gtest/gtest.h>

#include "shared/job/pass_schedule.h"

namespace tilefarm {
namespace {

TEST(PassSchedule, DoublesUpToTheLongestPass) {
    const std::vector<SampleRange> expected{{0, 1},   {1, 1},   {2, 2},     {4, 4},     {8, 8},     {16, 16},
                                            {32, 32}, {64, 64}, {128, 128}, {256, 256}, {512, 256}, {768, 8}};
    EXPECT_EQ(passSchedule(776), expected);
}

TEST(PassSchedule, CoversEverySampleOnceAndNeverExceedsTheLongestPass) {
    EXPECT_TRUE(passSchedule(0).empty());
    for (const uint32_t samples : {1u, 2u, 3u, 5u, 63u, 64u, 65u, 127u, 128u, 1000u, 1u << 20}) {
        uint32_t next = 0;
        for (const SampleRange range : passSchedule(samples)) {
            ASSERT_EQ(range.first, next);
            ASSERT_GE(range.count, 1u);
            ASSERT_LE(range.count, kMaxPassSamples);
            next = range.end();
        }
        EXPECT_EQ(next, samples);
    }
}

TEST(PassSchedule, OfALongerJobBeginsWithThatOfAShorterOne) {
    const auto shorter = passSchedule(300), longer = passSchedule(1000);
    for (size_t i = 0; i + 1 < shorter.size(); ++i) EXPECT_EQ(shorter[i], longer[i]);
}

TEST(TileGrid, CutsTheLastTilesToFit) {
    const TileGrid grid({.width = 100, .height = 50, .tileSize = 32});
    EXPECT_EQ(grid.columns, 4u);
    EXPECT_EQ(grid.rows, 2u);
    EXPECT_EQ(grid.rect(0), (Rect{0, 0, 32, 32}));
    EXPECT_EQ(grid.rect(3), (Rect{96, 0, 4, 32}));
    EXPECT_EQ(grid.rect(7), (Rect{96, 32, 4, 18}));
}

TEST(TileGrid, CoversEveryPixelOnce) {
    for (const uint32_t tileSize : {8u, 16u, 64u, 128u}) {
        const ImageSpec image{.width = 131, .height = 77, .tileSize = tileSize};
        const TileGrid grid(image);
        std::vector<int> covered(image.width * image.height, 0);
        for (uint32_t t = 0; t < grid.count(); ++t) {
            const Rect r = grid.rect(t);
            for (uint32_t y = r.y; y < r.y + r.height; ++y)
                for (uint32_t x = r.x; x < r.x + r.width; ++x) ++covered.at(y * image.width + x);
        }
        EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), static_cast<std::ptrdiff_t>(covered.size()));
    }
}

TEST(TileGrid, IsOneTileForASmallImageAndManyForTheLargest) {
    EXPECT_EQ(TileGrid({.width = 1, .height = 1, .tileSize = 1024}).rect(0), (Rect{0, 0, 1, 1}));
    EXPECT_EQ(TileGrid({.width = 32768, .height = 32768, .tileSize = 8}).count(), 4096u * 4096u);
}

}  // namespace
}  // namespace tilefarm
