#include "shared/image/difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

FloatImage uniform(uint32_t width, uint32_t height, float value) {
    return {
        width, height, {"R", "G", "B"}, std::vector(3, std::vector<float>(size_t{width} * height, value))};
}

TEST(Difference, OfAnImageFromItselfIsNothing) {
    const FloatImage image = uniform(4, 3, 0.3f);
    const ImageDifference d = difference(image, image);
    EXPECT_EQ(d.rmse, 0);
    EXPECT_EQ(d.relMse, 0);
    EXPECT_EQ(d.max, 0);
    EXPECT_EQ(d.meanDifference, 0);
    EXPECT_FLOAT_EQ(static_cast<float>(d.meanReference), 0.3f);
    EXPECT_TRUE(d.identical);
}

TEST(Difference, FollowsItsFormulas) {
    FloatImage a = uniform(2, 2, 2.f), b = uniform(2, 2, 2.f);
    a.planes[0][0] = 5;   // + 3
    a.planes[2][3] = -2;  // - 4
    b.planes[0][0] = 2;
    const ImageDifference d = difference(a, b);
    EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(25.0 / 12));
    EXPECT_DOUBLE_EQ(d.relMse, 25.0 / (4 + 0.01 * 0.01) / 12);
    EXPECT_DOUBLE_EQ(d.max, 4);
    EXPECT_DOUBLE_EQ(d.meanDifference, -1.0 / 12);
    EXPECT_DOUBLE_EQ(d.meanReference, 2);
    EXPECT_FALSE(d.identical);
}

TEST(Difference, TellsEqualValuesFromEqualBits) {
    const FloatImage a = uniform(1, 1, 0.f), b = uniform(1, 1, -0.f);
    EXPECT_EQ(difference(a, b).max, 0);
    EXPECT_FALSE(difference(a, b).identical);
}

TEST(Difference, OfTinyStepsOnLargeValuesIsNotLost) {
    const float large = 1e6f;
    const FloatImage a = uniform(64, 64, std::nextafter(large, 2e6f)), b = uniform(64, 64, large);
    EXPECT_DOUBLE_EQ(difference(a, b).meanDifference, 0.0625);
}

TEST(Difference, NamesThePixelThatIsNotFinite) {
    const FloatImage good = uniform(4, 3, 1.f);
    FloatImage bad = good;
    bad.planes[1][6] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(errorOf([&] { difference(bad, good); }).what(),
                HasSubstr("first image has nan in channel G at pixel (2, 1)"));
    bad.planes[1][6] = std::numeric_limits<float>::infinity();
    EXPECT_THAT(errorOf([&] { difference(good, bad); }).what(), HasSubstr("second image has inf"));
}

TEST(Difference, RefusesImagesThatDoNotMatch) {
    EXPECT_EQ(codeOf([] { difference(uniform(4, 3, 0), uniform(3, 4, 0)); }), ErrorCode::invalidArgument);
    FloatImage grey = uniform(2, 2, 0);
    grey.channels = {"Y", "G", "B"};
    EXPECT_THAT(errorOf([&] { difference(uniform(2, 2, 0), grey); }).what(), HasSubstr("no channel 'R'"));
    EXPECT_EQ(codeOf([] { difference(uniform(0, 0, 0), uniform(0, 0, 0)); }), ErrorCode::invalidArgument);
}

FloatImage noisy(uint32_t seed, float mean, float sigma) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal(mean, sigma);
    FloatImage image = uniform(100, 100, 0);
    for (auto& plane : image.planes)
        for (float& value : plane) value = normal(random);
    for (const char* name : {"variance.R", "variance.G", "variance.B"}) {
        image.channels.emplace_back(name);
        image.planes.emplace_back(10000, sigma * sigma);
    }
    return image;
}

TEST(StatisticalAgreement, HoldsForTwoRendersOfOneImage) {
    const auto agreement = statisticalAgreement(noisy(1, 1, 0.2f), noisy(2, 1, 0.1f));
    ASSERT_TRUE(agreement.has_value());
    EXPECT_LT(std::abs(agreement->meanZ), 4);
    EXPECT_GT(agreement->withinFourSigma, 0.999);
}

TEST(StatisticalAgreement, FindsABiasFarBelowTheNoiseOfAPixel) {
    const auto agreement = statisticalAgreement(noisy(1, 1, 0.2f), noisy(2, 1.02f, 0.2f));
    EXPECT_LT(agreement->meanZ, -4);
}

TEST(StatisticalAgreement, FindsPixelsThatTheNoiseDoesNotExplain) {
    FloatImage spoilt = noisy(2, 1, 0.1f);
    for (size_t i = 0; i < 500; ++i) spoilt.planes[0][i] += i % 2 == 0 ? 3.f : -3.f;
    EXPECT_LT(statisticalAgreement(noisy(1, 1, 0.1f), spoilt)->withinFourSigma, 0.99);
}

TEST(StatisticalAgreement, NeedsTheVariances) {
    EXPECT_FALSE(statisticalAgreement(uniform(2, 2, 1), uniform(2, 2, 1)).has_value());
}

}  // namespace
}  // namespace tilefarm
