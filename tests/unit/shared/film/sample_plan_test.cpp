#include "shared/film/sample_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/job/job.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const StopCondition kTarget{.samples = 1024, .relativeError = 0.1, .minSamples = 16};

// With `variance` = 1 a tile of 100 pixels has the relative error 0.1.
TileError tileError(double variance, uint32_t samples = 16) {
    return {.pixels = 100, .samples = samples, .variance = variance, .earlier = variance};
}

SampleDecision decideFor(const StopCondition& stop, const std::vector<TileError>& tiles,
                         const FrameCost& cost = {}) {
    return decide(stop, passSchedule(stop.samples), tiles, cost);
}

TEST(SamplePlan, WithoutAConditionAllLevelsAreFree) {
    EXPECT_EQ(freeLevels({.samples = 64}, passSchedule(64)), 7u);
    EXPECT_EQ(freeLevels({.samples = 64, .relativeError = 0.1, .minSamples = 16}, passSchedule(64)), 5u);
    EXPECT_EQ(freeLevels({.samples = 64, .relativeError = 0.1, .minSamples = 17}, passSchedule(64)), 6u);
    EXPECT_EQ(freeLevels({.samples = 8, .relativeError = 0.1, .minSamples = 16}, passSchedule(8)), 4u);
    EXPECT_EQ(freeLevels({.samples = 64, .wallSeconds = 1}, passSchedule(64)), 1u);
}

TEST(SamplePlan, EndsOnceTheErrorIsMet) {
    const SampleDecision end = decideFor(kTarget, {tileError(0.5), tileError(1.5)});
    EXPECT_EQ(end.stop, StopReason::relativeError);
    EXPECT_THAT(end.tiles, IsEmpty());
    EXPECT_EQ(end.pixelSamples, 2u * 100 * 16);
    EXPECT_EQ(end.passes, 10u);
}

TEST(SamplePlan, PromotesTheTilesThatHoldTheError) {
    const SampleDecision next = decideFor(kTarget, {tileError(0.1), tileError(5), tileError(0.1), tileError(0.3)});
    EXPECT_FALSE(next.stop);
    EXPECT_THAT(next.tiles, ElementsAre(1));
    EXPECT_EQ(next.pixelSamples, 100u * (3 * 16 + 32));
}

TEST(SamplePlan, GivesEachTileOnePassAtATimeAndForeseesTheRest) {
    const SampleDecision next = decideFor(kTarget, {tileError(0.1), tileError(10)});
    EXPECT_THAT(next.tiles, ElementsAre(1));
    EXPECT_EQ(next.pixelSamples, 100u * (16 + 128));  // 10 / 8 + 0.1 <= 2
    EXPECT_EQ(next.passes, 5u + 8);
}

TEST(SamplePlan, ComparesErrorsPerSampleTheyCost) {
    // Half of the error each; the larger tile costs four times as much.
    TileError large = tileError(1.9);
    large.pixels = 400;
    EXPECT_THAT(
        decideFor({.samples = 64, .relativeError = 0.08, .minSamples = 16}, {large, tileError(1.9)}).tiles,
        ElementsAre(1));
    // The same error for more samples taken: a further pass is worth less.
    EXPECT_THAT(decideFor(kTarget, {tileError(1.2, 64), tileError(1.2, 16)}).tiles, ElementsAre(1));
}

TEST(SamplePlan, GoesByTheEarlierDataOfATileButByTheLatestOfTheFrame) {
    TileError lucky = tileError(0.1), unlucky = tileError(4);
    lucky.earlier = 2;
    unlucky.earlier = 0.5;
    EXPECT_THAT(decideFor(kTarget, {lucky, unlucky}).tiles, ElementsAre(0));
    lucky.rest();
    unlucky.rest();
    EXPECT_THAT(decideFor(kTarget, {lucky, unlucky}).tiles, ElementsAre(1));
}

TEST(SamplePlan, ATileWhoseErrorIsNewIsNotForgotten) {
    TileError surprise = tileError(4);
    surprise.earlier = 0;
    EXPECT_THAT(decideFor(kTarget, {tileError(1, 1024), surprise}).tiles, ElementsAre(1));
}

TEST(SamplePlan, ScalesWhatWasKnownToTheSamplesThereAre) {
    TileError tile{.pixels = 100};
    tile.reach(1, 0);
    tile.reach(2, 8);
    EXPECT_EQ(tile.earlier, 8);  // one sample knows of no variance
    tile.reach(4, 3);
    EXPECT_EQ(tile.earlier, 4);
    EXPECT_EQ(tile.variance, 3);
    EXPECT_EQ(tile.samples, 4u);
}

TEST(SamplePlan, EndsAtTheSampleLimit) {
    const SampleDecision end = decideFor(kTarget, {tileError(50, 1024), tileError(0, 16)});
    EXPECT_EQ(end.stop, StopReason::samples);
    EXPECT_EQ(end.pixelSamples, 100u * (1024 + 16));
}

TEST(SamplePlan, BelievesNoErrorBeforeTheLeastSamples) {
    const std::vector<TileError> tiles{tileError(0, 4), tileError(0, 4)};
    const StopCondition stop{.samples = 64, .relativeError = 0.1, .minSamples = 16, .deviceSeconds = 100};
    EXPECT_THAT(decideFor(stop, tiles, {.deviceSeconds = 1}).tiles, ElementsAre(0, 1));
}

TEST(SamplePlan, DoesNotBeginWhatWouldExceedATimeLimit) {
    const std::vector<TileError> tiles{tileError(9), tileError(9)};
    const StopCondition stop{.samples = 1024, .deviceSeconds = 10, .wallSeconds = 5};
    EXPECT_THAT(decideFor(stop, tiles, {.deviceSeconds = 5, .wallSeconds = 2.5}).tiles, ElementsAre(0, 1));
    EXPECT_EQ(decideFor(stop, tiles, {.deviceSeconds = 5.1, .wallSeconds = 1}).stop,
              StopReason::deviceSeconds);
    EXPECT_EQ(decideFor(stop, tiles, {.deviceSeconds = 1, .wallSeconds = 2.6}).stop, StopReason::wallSeconds);
    EXPECT_EQ(decideFor(stop, tiles, {.deviceSeconds = 2.5, .wallSeconds = 1}).pixelSamples, 2u * 100 * 64);
}

TEST(SamplePlan, SaysWhyAFrameIsComplete) {
    StopCondition stop{.samples = 64};
    EXPECT_EQ(sentenceOf(StopReason::samples, stop, 64), "all 64 samples per pixel taken");
    stop.relativeError = 0.05;
    EXPECT_EQ(sentenceOf(StopReason::samples, stop, 37),
              "sample limit of 64 reached before the error target of 0.05");
    EXPECT_EQ(sentenceOf(StopReason::relativeError, stop, 37),
              "error target of 0.05 reached at 37 samples per pixel");
    stop.deviceSeconds = 2.5;
    EXPECT_EQ(sentenceOf(StopReason::deviceSeconds, stop, 37),
              "limit of 2.5 device seconds reached at 37 samples per pixel before the error target of 0.05");
    for (const auto reason :
         {StopReason::samples, StopReason::relativeError, StopReason::deviceSeconds, StopReason::wallSeconds})
        EXPECT_EQ(stopReasonFrom(toString(reason)), reason);
}

// ---- Does stopping bias the picture?

// A frame of tiles of which each has samples that are mostly dark and rarely bright: as light does that few
// paths find, which misleads an estimate of variance most.
class Frame {
public:
    static constexpr uint32_t kTiles = 16, kPixels = 64;

    Frame(const StopCondition& stop, uint32_t seed) : stop_(stop), schedule_(passSchedule(stop.samples)) {
        for (uint32_t t = 0; t < kTiles; ++t) {
            random_.emplace_back(seed * kTiles + t);
            errors_.push_back({.pixels = kPixels});
            sums_.emplace_back();
        }
        std::vector<uint32_t> next(kTiles);
        for (uint32_t t = 0; t < kTiles; ++t) next[t] = t;
        const uint32_t free = freeLevels(stop_, schedule_);
        for (uint32_t level = 0; level < free; ++level) render(next);
        while (stop_.decidesOnTheWay() && !next.empty()) {
            next = decide(stop_, schedule_, errors_, {}).tiles;
            for (uint32_t t = 0; t < kTiles; ++t)
                if (std::find(next.begin(), next.end(), t) == next.end()) errors_[t].rest();
            render(next);
        }
    }
    // Relative to the true one, which is 1 in every tile.
    double mean() const {
        double sum = 0;
        for (uint32_t t = 0; t < kTiles; ++t) sum += sums_[t].first / errors_[t].samples;
        return sum / (kTiles * kPixels);
    }
    uint32_t samples() const { return meanSamples(errors_); }

private:
    void render(const std::vector<uint32_t>& tiles) {
        for (const uint32_t t : tiles) {
            const SampleRange pass = *nextPass(schedule_, errors_[t].samples);
            const double chance = t % 4 == 0 ? 0.02 : 0.5;
            std::binomial_distribution<uint32_t> found(pass.count * kPixels, chance);
            const double light = found(random_[t]) / chance;
            sums_[t].first += light;
            sums_[t].second += light / chance;
            const double n = static_cast<double>(pass.end()) * kPixels, average = sums_[t].first / n;
            const double variance = (sums_[t].second / n - average * average) / pass.end();
            errors_[t].reach(pass.end(), pass.end() > 1 ? kPixels * variance : 0);
        }
    }

    StopCondition stop_;
    std::vector<SampleRange> schedule_;
    std::vector<TileError> errors_;
    std::vector<std::mt19937> random_;
    std::vector<std::pair<double, double>> sums_;  // of samples and of their squares
};

TEST(SamplePlan, StoppingDoesNotBiasTheMean) {
    const uint32_t frames = 4000;
    double sum = 0, squares = 0, samples = 0, most = 0;
    for (uint32_t seed = 0; seed < frames; ++seed) {
        const Frame frame({.samples = 4096, .relativeError = 0.25, .minSamples = 16}, seed);
        sum += frame.mean();
        squares += frame.mean() * frame.mean();
        samples += frame.samples();
        most = std::max(most, static_cast<double>(frame.samples()));
    }
    const double mean = sum / frames, variance = squares / frames - mean * mean;
    const double z = (mean - 1) / std::sqrt(variance / frames);
    RecordProperty("bias", std::to_string(mean - 1));
    RecordProperty("z", std::to_string(z));
    EXPECT_LT(std::abs(mean - 1), 0.001);
    EXPECT_LT(std::abs(z), 3) << mean;
    EXPECT_GT(samples / frames, 20);  // they did not all end at once
    EXPECT_LT(most, 1000);
}

}  // namespace
}  // namespace tilefarm
