#include "worker/render/environment_packer.h"

#include <gtest/gtest.h>

#include <numbers>

namespace tilefarm {
namespace {

Environment uniform(uint32_t width, uint32_t height, float value) {
    Environment e;
    e.image.width = width;
    e.image.height = height;
    for (uint32_t i = 0; i < width * height; ++i)
        e.image.rgbaFloat.insert(e.image.rgbaFloat.end(), {value, value, value, 1});
    return e;
}

TEST(EnvironmentPacker, FluxOfAUniformSkyIsFourPi) {
    const PackedEnvironment packed = packEnvironment(uniform(64, 32, 2));
    EXPECT_NEAR(packed.flux(), 2 * 4 * std::numbers::pi, 2 * 4 * std::numbers::pi * 1e-3);
    EXPECT_EQ(packed.alias.size(), 64u * 32u);
}

TEST(EnvironmentPacker, WeighsRowsByTheirSolidAngle) {
    const PackedEnvironment packed = packEnvironment(uniform(4, 4, 1));
    EXPECT_NEAR(packed.texels[0].a, std::sin(std::numbers::pi / 8), 1e-6);
    EXPECT_NEAR(packed.texels[4].a, std::sin(3 * std::numbers::pi / 8), 1e-6);
}

TEST(EnvironmentPacker, ABlackSkyIsNoLight) {
    const PackedEnvironment packed = packEnvironment(uniform(8, 4, 0));
    EXPECT_FALSE(packed.lit());
    EXPECT_EQ(packed.flux(), 0);
    EXPECT_TRUE(packed.alias.empty());
}

TEST(EnvironmentPacker, NoEnvironmentIsEmpty) {
    EXPECT_FALSE(packEnvironment({}).lit());
    EXPECT_EQ(packEnvironment({}).flux(), 0);
}

}  // namespace
}  // namespace tilefarm
