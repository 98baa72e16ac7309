#include "worker/render/dispatch_counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tilefarm {
namespace {

TEST(ExactSum, LimbsCountPowersOfTwo) {
    std::vector<uint32_t> limbs(gpu::SUM_LIMBS);
    EXPECT_EQ(exactSum(limbs), 0);
    limbs[0] = 1;
    EXPECT_EQ(exactSum(limbs), 0x1p-32);
    limbs = {0, 0, 256, 0, 0, 0};  // 2^-8 each
    EXPECT_EQ(exactSum(limbs), 1);
    limbs = {0, 0, 0, 0, 0, 15};  // the largest term but its fraction, 2^28 each
    EXPECT_EQ(exactSum(limbs), 15 * 0x1p28);
}

TEST(ExactSum, FullLimbsDoNotOverflow) {
    // 2^20 invocations that each add all bits of every limb.
    const std::vector<uint32_t> limbs(gpu::SUM_LIMBS, 0xfffu << 20);
    double expected = 0;
    for (int i = 0; i < 6; ++i) expected += 0xfff.0p20 * std::ldexp(1.0, 12 * i - 32);
    EXPECT_DOUBLE_EQ(exactSum(limbs), expected);
}

TEST(ExactSum, CarriesDoNotDependOnWhichLimbHoldsThem) {
    EXPECT_EQ(exactSum(std::vector<uint32_t>{5u << 12, 7, 0, 0, 0, 0}),
              exactSum(std::vector<uint32_t>{0, 12, 0, 0, 0, 0}));
}

TEST(DispatchCounts, RaysOfAllTilesAreMoreThan32BitsHold) {
    std::vector<uint32_t> words(DispatchCounts::words(2));
    // 2^20 pixels of 40,000 rays each in both tiles: limbs of whole numbers start at 2^-8.
    for (size_t tile = 0; tile < 2; ++tile) {
        uint32_t* rays = &words[gpu::COUNTER_COUNT + gpu::TILE_COUNTERS * tile + gpu::TILE_RAYS];
        rays[2] = ((40000u << 8) & 0xfffu) << 20;
        rays[3] = ((40000u >> 4) & 0xfffu) << 20;
    }
    EXPECT_EQ(DispatchCounts(words).rays(), uint64_t{2} * 40000 << 20);
}

TEST(DispatchCounts, TilesKeepTheirOwn) {
    std::vector<uint32_t> words(DispatchCounts::words(2));
    uint32_t* second = &words[gpu::COUNTER_COUNT + gpu::TILE_COUNTERS];
    second[gpu::TILE_TRUNCATED] = 3;
    second[gpu::TILE_TRUNCATED_THROUGHPUT + 2] = 128;
    second[gpu::TILE_CLAMPED] = 2;
    second[gpu::TILE_CLAMPED_RADIANCE + 3] = 1;  // 2^4
    second[gpu::TILE_REJECTED] = 4;
    second[gpu::TILE_BEHIND_GLASS] = 5;
    PassFaults first, other;
    DispatchCounts(words).addTile(0, first);
    DispatchCounts(words).addTile(1, other);
    EXPECT_EQ(first, PassFaults{});
    EXPECT_EQ(other.truncatedPaths, 3u);
    EXPECT_EQ(other.truncatedThroughput, 0.5);
    EXPECT_EQ(other.clampedSamples, 2u);
    EXPECT_EQ(other.clampedLuminance, 16);
    EXPECT_EQ(other.rejectedPaths, 4u);
    EXPECT_EQ(other.lightsBehindGlass, 5u);
}

}  // namespace
}  // namespace tilefarm
