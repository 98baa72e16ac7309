#include "shared/image/metrics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "shared/image/flip.h"

namespace tilefarm {
namespace {

using Colour = std::array<float, 3>;

template <typename Shade>
FloatImage imageOf(uint32_t width, uint32_t height, Shade shade) {
    FloatImage image{
        width, height, {"R", "G", "B"}, std::vector(3, std::vector<float>(size_t{width} * height))};
    for (uint32_t i = 0; i < width * height; ++i) {
        const Colour colour = shade(i % width, i / width);
        for (size_t c = 0; c < 3; ++c) image.planes[c][i] = colour[c];
    }
    return image;
}

FloatImage even(const Colour& colour, uint32_t side = 8) {
    return imageOf(side, side, [&](uint32_t, uint32_t) { return colour; });
}

std::optional<double> valueOf(std::string_view name, const FloatImage& a, const FloatImage& b) {
    for (const ImageMetric& metric : imageMetrics())
        if (metric.name == name) return metric.of({a, b});
    ADD_FAILURE() << "no metric " << name;
    return {};
}

TEST(ImageMetrics, HaveNamesOfTheirOwnAndAreNothingForEqualImages) {
    std::set<std::string_view> names;
    const FloatImage image = even({0.2f, 0.5f, 0.7f});
    for (const ImageMetric& metric : imageMetrics()) {
        EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
        EXPECT_FALSE(metric.title.empty() || metric.means.empty()) << metric.name;
        if (metric.name == "meanReference") continue;
        EXPECT_EQ(metric.of({image, image}).value_or(0), 0) << metric.name;
    }
}

TEST(ImageMetrics, FollowTheirFormulas) {
    const FloatImage a = even({1.5f, 2, 1}), b = even({1, 2, 2});
    EXPECT_DOUBLE_EQ(*valueOf("rmse", a, b), std::sqrt(1.25 / 3));
    EXPECT_DOUBLE_EQ(*valueOf("mape", a, b), 100 * (0.5 / 1.01 + 1 / 2.01) / 3);
    EXPECT_DOUBLE_EQ(*valueOf("meanPercent", a, b), 100 * -0.5 / 5);
    EXPECT_EQ(valueOf("meanPercent", a, even({0, 0, 0})), std::nullopt);
    EXPECT_EQ(valueOf("meanZ", a, b), std::nullopt) << "without variances";
}

TEST(ImageMetrics, TrimsTheWorstThousandthOfThePixels) {
    FloatImage a = even({1, 1, 1}, 40);  // 1,600 pixels: 2 of them
    const FloatImage b = a;
    a.planes[0][7] = a.planes[1][900] = 1000;
    a.planes[2][3] = 2;
    EXPECT_GT(*valueOf("relMse", a, b), 100);
    EXPECT_NEAR(*valueOf("relMseTrimmed", a, b), 1 / 1.0001 / (3 * 1598.0), 1e-12);
}

TEST(Flip, IsOneBetweenTheColoursThatDifferMost) {
    EXPECT_NEAR(meanFlip(even({0, 1, 0}), even({0, 0, 1}), {ToneCurve::linear}), 1, 1e-9);
    EXPECT_NEAR(meanFlip(even({0, 0, 0}), even({1, 1, 1}), {ToneCurve::linear}), 0.9673797621994682, 1e-6);
}

// Values of a dense evaluation of the paper's formulas in numpy, with two-dimensional kernels.
TEST(Flip, GivesThePapersValues) {
    const FloatImage reference = imageOf(32, 20, [](uint32_t x, uint32_t y) {
        return Colour{static_cast<float>((x * 7 + y * 3) % 11) / 10, static_cast<float>((x + y * 5) % 7) / 6,
                      static_cast<float>((x * 3 + y) % 13) / 12};
    });
    const FloatImage test = imageOf(32, 20, [](uint32_t x, uint32_t y) {
        return Colour{static_cast<float>((x * 7 + y * 3) % 11) / 10, static_cast<float>((x + y * 5) % 7) / 8,
                      static_cast<float>((x * 3 + y * 2) % 13) / 12};
    });
    EXPECT_NEAR(meanFlip(test, reference, {ToneCurve::linear}), 0.43132298024455107, 1e-6);
    EXPECT_NEAR(meanFlip(test, reference, {ToneCurve::linear}, 30), 0.4783975343776733, 1e-6);
}

}  // namespace
}  // namespace tilefarm
