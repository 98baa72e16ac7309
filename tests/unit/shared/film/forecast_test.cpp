#include "shared/film/forecast.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tilefarm {
namespace {

// 100 pixels at 16 samples with the relative error 0.1 ± 10 %, which took 2 s at a millisecond per pixel
// sample.
FrameOutlook uniform() {
    FrameOutlook frame;
    frame.tiles = {{.pixels = 100, .samples = 16, .variance = 1, .earlier = 1}};
    frame.error = {.relativeError = 0.1, .low = 0.09, .high = 0.11};
    frame.deviceSeconds = 2;
    frame.pace = {.seconds = 1e-3, .spread = 0};
    return frame;
}

TEST(Forecast, OfAllPixelsAlikeFallsWithTheRoot) {
    const auto f = forecast(uniform(), passSchedule(65536), 0.05);
    ASSERT_TRUE(f);
    EXPECT_DOUBLE_EQ(f->relativeError, 0.05);
    EXPECT_NEAR(f->samples, 64, 1e-9);
    EXPECT_NEAR(f->deviceSeconds, 2 + 48 * 0.1, 1e-9);
    // 0.81 and 1.21 times the samples.
    EXPECT_NEAR(f->low, 2 + (64 * 0.81 - 16) * 0.1, 1e-9);
    EXPECT_NEAR(f->high, 2 + (64 * 1.21 - 16) * 0.1, 1e-9);
}

TEST(Forecast, AddsWhatThePaceLeavesOpen) {
    FrameOutlook frame = uniform();
    frame.error.low = frame.error.high = 0.1;
    frame.pace.spread = 0.05;
    const auto f = forecast(frame, passSchedule(65536), 0.05);
    EXPECT_NEAR(f->high - f->deviceSeconds, 4.8 * 1.96 * 0.05, 1e-9);
    EXPECT_NEAR(f->deviceSeconds - f->low, 4.8 * 1.96 * 0.05, 1e-9);
}

TEST(Forecast, OfATargetThatIsMetCostsNothingMore) {
    const auto f = forecast(uniform(), passSchedule(64), 0.2);
    EXPECT_DOUBLE_EQ(f->deviceSeconds, 2);
    EXPECT_DOUBLE_EQ(f->low, 2);
    EXPECT_NEAR(f->samples, 16, 1e-9);
}

TEST(Forecast, IsNoneBeyondTheSchedule) {
    EXPECT_TRUE(forecast(uniform(), passSchedule(64), 0.05));
    EXPECT_FALSE(forecast(uniform(), passSchedule(63), 0.05));
    FrameOutlook exact = uniform();
    exact.error = {};
    EXPECT_FALSE(forecast(exact, passSchedule(64), 0.05));
}

TEST(Forecast, SendsSamplesWhereTheErrorIs) {
    FrameOutlook frame = uniform();
    frame.tiles = {{.pixels = 50, .samples = 16, .variance = 0.9, .earlier = 0.9},
                   {.pixels = 50, .samples = 16, .variance = 0.1, .earlier = 0.1}};
    const auto f = forecast(frame, passSchedule(65536), 0.05);
    // 0.25 is allowed: 0.9 / 4 + 0.1 is too much, and then the second tile gains more per sample.
    EXPECT_NEAR(f->samples, (128 + 32) / 2.0, 1e-9);
    EXPECT_NEAR(f->deviceSeconds, 2 + 50 * (112 + 16) * 1e-3, 1e-9);
}

TEST(Forecast, OfSamplesTellsTheirError) {
    const Forecast f = forecastSamples(uniform(), 64);
    EXPECT_NEAR(f.relativeError, 0.05, 1e-12);
    EXPECT_NEAR(f.deviceSeconds, 2 + 4.8, 1e-9);
    EXPECT_EQ(f.samples, 64);
}

TEST(Forecast, TakesThePaceOfTheLatestSamples) {
    const CostPoint curve[]{{100, 1}, {200, 1.2}, {400, 1.6}};
    EXPECT_FALSE(paceOf(std::span(curve, 1)));
    EXPECT_NEAR(paceOf(std::span(curve, 2))->seconds, 0.002, 1e-12);
    EXPECT_NEAR(paceOf(std::span(curve, 2))->spread, 2, 1e-9);  // 0.01 a sample before
    EXPECT_NEAR(paceOf(curve)->seconds, 0.002, 1e-12);
    EXPECT_NEAR(paceOf(curve)->spread, 0.02, 1e-12);
}

}  // namespace
}  // namespace tilefarm
