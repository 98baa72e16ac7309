// Jobs with an error target: the same picture whoever renders it, in whatever order it arrives.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shared/film/error_sums.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

JobSpec adaptiveJob() {
    JobSpec spec = smallJob(512);
    spec.stop.relativeError = 0.2;
    spec.stop.minSamples = 4;
    return spec;
}

// The frame without a farm, as tilefarm-worker render goes about it.
std::vector<FilmTile> renderAdaptively(const JobSpec& spec) {
    const TileGrid grid(spec.image);
    const auto schedule = passSchedule(spec.stop.samples);
    std::vector<FilmTile> tiles;
    std::vector<TileError> errors;
    std::vector<uint32_t> next;
    for (uint32_t i = 0; i < grid.count(); ++i) {
        tiles.emplace_back(grid.rect(i));
        errors.push_back({.pixels = grid.rect(i).area()});
        next.push_back(i);
    }
    const uint32_t free = freeLevels(spec.stop, schedule);
    for (uint32_t round = 0; !next.empty(); ++round) {
        for (const uint32_t i : next) {
            tiles[i].merge(renderPass(grid, {i, *nextPass(schedule, errors[i].samples)}));
            ErrorSums sums;
            sums.add(tiles[i]);
            errors[i].reach(tiles[i].mergedSamples, sums.relativeVariance);
        }
        if (round + 1 < free) continue;
        next = decide(spec.stop, schedule, errors, {}).tiles;
        for (uint32_t i = 0; i < grid.count(); ++i)
            if (!std::binary_search(next.begin(), next.end(), i)) errors[i].rest();
    }
    return tiles;
}

// Leases of few passes, all that there are at a time, brought in any order.
void finishShuffled(TestFarm& farm, std::mt19937& random) {
    while (true) {
        std::vector<Lease> leases;
        while (auto lease = farm.tryLease("w" + std::to_string(leases.size() % 3))) leases.push_back(*lease);
        if (leases.empty()) return;
        std::shuffle(leases.begin(), leases.end(), random);
        for (const Lease& lease : leases) farm.deliver(lease);
    }
}

QueueConfig fewPasses(uint64_t passes) {
    QueueConfig config;
    config.mostPixelsPerLease = passes * 16 * 16;
    return config;
}

TEST(Adaptive, GivesTheSameFilmForAnyLeasesAndOrder) {
    const JobSpec spec = adaptiveJob();
    const auto wanted = renderAdaptively(spec);
    const auto [least, most] = std::minmax_element(
        wanted.begin(), wanted.end(), [](auto& a, auto& b) { return a.mergedSamples < b.mergedSamples; });
    ASSERT_LT(least->mergedSamples, most->mergedSamples) << "the tiles are all alike";
    std::mt19937 random(1);
    for (const uint64_t passes : {1, 2, 5, 100}) {
        TestFarm farm(fewPasses(passes));
        const std::string id = farm.scheduler->submit(spec).job.id;
        finishShuffled(farm, random);
        EXPECT_TRUE(sameBits(farm.film(id), wanted)) << passes;
        EXPECT_EQ(farm.frame(id).stopReason, StopReason::relativeError);
        EXPECT_LE(farm.frame(id).relativeError, 0.2);
    }
}

TEST(Adaptive, CountsWhatItTookAndWhatItWillTake) {
    TestFarm farm(fewPasses(1));
    const JobSpec spec = adaptiveJob();
    const std::string id = farm.scheduler->submit(spec).job.id;
    double before = 0;
    while (auto lease = farm.tryLease()) {
        farm.deliver(*lease);
        const JobRow job = farm.job(id);
        EXPECT_GE(job.pixelSamples, job.pixelSamplesMerged);
        EXPECT_TRUE(farm.scheduler->sweep().empty());
        before = job.fractionDone();
    }
    EXPECT_EQ(before, 1.0);
    farm.images->finishFrames();
    const JobRow job = farm.job(id);
    EXPECT_EQ(job.state, JobState::completed);
    EXPECT_EQ(job.passes, job.passesMerged);
    EXPECT_EQ(job.samplesMerged, farm.frame(id).samplesMerged);
    EXPECT_EQ(stopSentence(farm.frame(id), spec.stop).find("error target of 0.2 reached at "), 0u);
    // Of one frame they stay, for forecasts.
    farm.store->read([&](const ConstTables& t) { EXPECT_EQ(t.frames.tileErrors(job.key, 0).size(), 6u); });
}

TEST(Adaptive, FramesThatHaveNotBegunAreExpectedToTakeAsMuch) {
    TestFarm farm(fewPasses(6));
    JobSpec spec = adaptiveJob();
    spec.frames.count = 3;
    const std::string id = farm.scheduler->submit(spec).job.id;
    EXPECT_EQ(farm.job(id).pixelSamples, 3u * 40 * 24 * 512);
    do
        farm.deliver(farm.lease());
    while (farm.frame(id, 0).state == FrameState::active);
    const JobRow job = farm.job(id);
    EXPECT_LT(job.pixelSamples, 4 * farm.frame(id, 0).pixelSamples);
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
    EXPECT_EQ(farm.job(id).passes, farm.job(id).passesMerged);
    EXPECT_EQ(farm.job(id).pixelSamples, farm.job(id).pixelSamplesMerged);
}

// Between any two durable steps of a merge, those at fixed points among them.
TEST(Adaptive, ContinuesAfterAKillAnywhere) {
    struct Kill {};
    const JobSpec spec = adaptiveJob();
    const auto wanted = renderAdaptively(spec);
    std::mt19937 random(2);
    TestFarm farm(fewPasses(2));
    const std::string id = farm.scheduler->submit(spec).job.id;
    for (int kills = 0;;) {
        const auto lease = farm.tryLease();
        if (!lease) {
            if (farm.frame(id).state != FrameState::active && kills > 0) break;
            farm.clock.advance(farm.config.leaseTime);  // it was lost with its worker
            continue;
        }
        farm.probe = [&](std::string_view) {
            if (random() % 4 == 0) throw Kill{};
        };
        try {
            farm.deliver(*lease);
        } catch (const Kill&) {
            ++kills;
            farm.reopen();
        }
        farm.probe = {};
    }
    EXPECT_TRUE(sameBits(farm.film(id), wanted));
    EXPECT_TRUE(farm.scheduler->sweep().empty());
}

TEST(Adaptive, EndsBeforeALimitOfDeviceSeconds) {
    TestFarm farm(fewPasses(6));
    JobSpec spec = smallJob(512);
    spec.stop.deviceSeconds = 7;
    const std::string id = farm.scheduler->submit(spec).job.id;
    while (auto lease = farm.tryLease())
        farm.deliver(*lease, renderLease(*lease), static_cast<double>(lease->passes.front().samples.count));
    const FrameRow frame = farm.frame(id);
    EXPECT_EQ(frame.state, FrameState::finishing);
    EXPECT_EQ(frame.stopReason, StopReason::deviceSeconds);
    EXPECT_EQ(frame.samplesMerged, 4u);  // a second for each; 8 would be too many
}

TEST(Adaptive, EndsBeforeALimitOfWallSeconds) {
    TestFarm farm(fewPasses(6));
    JobSpec spec = smallJob(512);
    spec.stop.wallSeconds = 3;
    spec.stop.relativeError = 1e-6;
    const std::string id = farm.scheduler->submit(spec).job.id;
    while (auto lease = farm.tryLease()) {
        farm.clock.advance(Milliseconds(1000));
        farm.deliver(*lease);
    }
    EXPECT_EQ(farm.frame(id).stopReason, StopReason::wallSeconds);
    EXPECT_EQ(stopSentence(farm.frame(id), spec.stop),
              "limit of 3 seconds reached at 2 samples per pixel before the error target of 1e-06");
}

TEST(Adaptive, EndsAtTheSampleLimit) {
    TestFarm farm;
    JobSpec spec = smallJob(32);
    spec.stop.relativeError = 1e-6;
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    EXPECT_EQ(farm.frame(id).stopReason, StopReason::samples);
    EXPECT_EQ(farm.frame(id).samplesMerged, 32u);
    EXPECT_TRUE(farm.job(id).state == JobState::completed);
}

}  // namespace
}  // namespace tilefarm
