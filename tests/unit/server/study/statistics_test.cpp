#include "server/study/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

FloatImage grey(std::vector<float> values, std::vector<float> variances = {}) {
    FloatImage image{
        .width = static_cast<uint32_t>(values.size()), .height = 1, .channels = {}, .planes = {}};
    for (const char* channel : {"R", "G", "B"}) {
        image.channels.emplace_back(channel);
        image.planes.push_back(values);
        if (variances.empty()) continue;
        image.channels.push_back(std::string("variance.") + channel);
        image.planes.push_back(variances);
    }
    return image;
}

TEST(StudyStatistics, GiveAMeanItsInterval) {
    const std::vector<double> values{1, 2, 3};  // deviation 1, so 1/√3 of the mean; t of 2 is 4.303
    const Estimate mean = estimateOf(values);
    EXPECT_DOUBLE_EQ(mean.value, 2);
    EXPECT_NEAR(mean.standardError, 0.57735, 1e-5);
    EXPECT_NEAR(mean.low, 2 - 4.303 * 0.57735, 1e-4);
    EXPECT_NEAR(mean.high, 2 + 4.303 * 0.57735, 1e-4);
    const Estimate alone = estimateOf(std::vector<double>{7});
    EXPECT_EQ(alone.low, 7);
    EXPECT_EQ(alone.high, 7);
    EXPECT_EQ(codeOf([] { estimateOf({}); }), ErrorCode::invalidArgument);
}

TEST(StudyStatistics, KnowStudentsTable) {
    EXPECT_DOUBLE_EQ(studentQuantile(1), 12.706);
    EXPECT_DOUBLE_EQ(studentQuantile(4), 2.776);
    EXPECT_NEAR(studentQuantile(30), 2.0423, 1e-3);
    EXPECT_NEAR(studentQuantile(120), 1.9799, 1e-3);
    EXPECT_NEAR(studentQuantile(100000), 1.96, 1e-3);
}

TEST(StudyStatistics, AverageRatiosByTheirLogarithms) {
    const Estimate of = geometricEstimate(std::vector<double>{1, 4}).value();
    EXPECT_NEAR(of.value, 2, 1e-12);  // logarithms 0 and 1.386: mean 0.693, error of it 0.693
    EXPECT_NEAR(of.high, 2 * std::exp(12.706 * 0.693147), 10);
    EXPECT_FALSE(geometricEstimate(std::vector<double>{1, 0}));
}

TEST(StudyStatistics, MeasureABiasInItsStandardDeviations) {
    const Estimate off{.value = 3, .standardError = 0.6, .low = 0, .high = 0};
    EXPECT_NEAR(zOf(off, 0), 5, 1e-12);
    EXPECT_NEAR(zOf(off, 0.64), 3, 1e-12);  // √(0.36 + 0.64) = 1
    EXPECT_EQ(zOf({}, 0), 0);
}

// Pixels 1 and 2, seen as 1.5 and 2 by one seed and as 2.5 and 2 by the other: means 2 and 2.
TEST(StudyStatistics, SplitTheErrorIntoVarianceAndBias) {
    const FloatImage reference = grey({1, 2});
    SeedSpread plain(reference, SeedSpread::Weight::plain);
    plain.add(grey({1.5f, 2}));
    plain.add(grey({2.5f, 2}));
    EXPECT_DOUBLE_EQ(plain.meanSquare(), (0.25 + 2.25) / 2 / 2);
    EXPECT_DOUBLE_EQ(plain.variance(), 0.5 / 2);  // (0.25 + 0.25) / (2 − 1) of one pixel of two
    EXPECT_DOUBLE_EQ(plain.squaredBias(), 0.375);

    const FloatImage bright = grey({10, 10});
    SeedSpread relative(bright, SeedSpread::Weight::relative);
    relative.add(grey({11, 9}));
    EXPECT_NEAR(relative.meanSquare(), 1 / 100.0001, 1e-12);
    EXPECT_EQ(relative.variance(), 0);
}

TEST(StudyStatistics, TakeTheReferencesOwnNoiseOff) {
    const FloatImage reference = grey({1, 1}, {0.01f, 0.03f});
    SeedSpread spread(reference, SeedSpread::Weight::plain);
    spread.add(grey({1.5f, 1.5f}));
    EXPECT_NEAR(spread.referenceVariance(), 0.02, 1e-9);
    EXPECT_NEAR(spread.meanSquare(), 0.25 - 0.02, 1e-9);
    EXPECT_EQ(codeOf([&] { spread.add(grey({1})); }), ErrorCode::invalidArgument);
}

TEST(StudyStatistics, FindWhatNothingIsBetterThan) {
    const std::vector<CostPoint> points{{1, 4}, {2, 2}, {2, 3}, {4, 1}, {5, 1}, {1, 4}};
    EXPECT_EQ(paretoFront(points), (std::vector<bool>{true, true, false, true, false, true}));
    EXPECT_TRUE(paretoFront({}).empty());
}

}  // namespace
}  // namespace tilefarm
