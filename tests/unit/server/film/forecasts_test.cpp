// What jobs are expected to take, while they are rendered and when they have ended.
#include "server/report/forecasts.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

using nlohmann::json;

QueueConfig oneLevelALease() {
    QueueConfig config;
    config.mostPixelsPerLease = 40 * 24;
    return config;
}

class ForecastsTest : public testing::Test {
protected:
    // Half a second for every sample of all pixels, a quarter of it by each of two workers.
    void deliver(const Lease& lease) {
        uint64_t pixelSamples = 0;
        for (const LeasedPass& pass : lease.passes)
            pixelSamples += TileGrid(lease.spec.image).rect(pass.tile).area() * pass.samples.count;
        farm.deliver(lease, renderLease(lease), static_cast<double>(pixelSamples) * 0.5 / (40 * 24));
    }
    // Until the frame has so many samples or nothing is left.
    void renderTo(const std::string& id, uint32_t samples) {
        while (const auto lease = farm.tryLease()) {
            deliver(*lease);
            if (farm.frame(id).samplesMerged >= samples) break;
        }
    }
    json view(const std::string& id, uint32_t frames = 1, const std::vector<double>& targets = {0.1}) {
        json result;
        farm.store->read([&](const ConstTables& t) {
            result = forecastView(t, *t.jobs.find(id), farm.info(id)->spec, targets, frames);
        });
        return result;
    }

    TestFarm farm{oneLevelALease()};
};

TEST_F(ForecastsTest, StandBesideTheOutcome) {
    const std::string id = farm.scheduler->submit(smallJob(512)).job.id;
    renderTo(id, 32);
    EXPECT_FALSE(farm.frame(id).forecastAt);
    renderTo(id, 64);  // 32 of 256 seconds
    FrameRow frame = farm.frame(id);
    ASSERT_TRUE(frame.forecastAt);
    EXPECT_NEAR(*frame.forecastAt, 32, 1e-9);
    EXPECT_NEAR(*frame.forecastSeconds, 256, 1e-9);
    EXPECT_LT(*frame.forecastLow, 255);
    EXPECT_GT(*frame.forecastHigh, 257);
    EXPECT_EQ(keptForecast(frame)["outcome"], nullptr);
    renderTo(id, 512);
    frame = farm.frame(id);
    EXPECT_NEAR(*frame.forecastAt, 32, 1e-9);  // the first one stays
    EXPECT_NEAR(keptForecast(frame)["outcome"], 256, 1e-9);
}

TEST_F(ForecastsTest, AreNoneBeforeThreeLevels) {
    const std::string id = farm.scheduler->submit(smallJob(64)).job.id;
    EXPECT_EQ(view(id)["basis"], nullptr);
    EXPECT_EQ(view(id)["forecast"], nullptr);
    EXPECT_TRUE(view(id)["targets"].empty());
    renderTo(id, 2);
    EXPECT_EQ(view(id)["basis"], nullptr);
    renderTo(id, 4);
    EXPECT_EQ(view(id)["basis"]["samples"], 4);
}

TEST_F(ForecastsTest, CountFramesAndTheWorkersThatTookPart) {
    const std::string id = farm.scheduler->submit(smallJob(64)).job.id;
    renderTo(id, 8);
    const json one = view(id), many = view(id, 10);
    EXPECT_NEAR(one["forecast"]["deviceSeconds"]["value"], 32, 1e-9);
    EXPECT_NEAR(one["forecast"]["samples"], 64, 1e-9);
    EXPECT_NEAR(many["forecast"]["frameDeviceSeconds"]["value"], 32, 1e-9);
    EXPECT_NEAR(many["forecast"]["deviceSeconds"]["value"], 320, 1e-9);
    EXPECT_NEAR(many["forecast"]["wallSeconds"]["value"], 320, 1e-6);  // one worker
    ASSERT_EQ(many["workers"].size(), 1u);
    EXPECT_NEAR(many["workers"][0]["samplesPerSecond"], 40 * 24 / 0.5, 1e-6);
}

TEST_F(ForecastsTest, OfErrorTargetsFollowTheSquareRoot) {
    const std::string id = farm.scheduler->submit(smallJob(64)).job.id;
    renderTo(id, 16);
    const json basis = view(id)["basis"];
    const double error = basis["relativeError"];
    const json target = view(id, 1, {error / 4})["targets"][0]["forecast"];
    EXPECT_NEAR(target["samples"], 16 * 16, 1e-6);
    EXPECT_NEAR(target["deviceSeconds"]["value"], 128, 1e-6);
    EXPECT_LT(target["deviceSeconds"]["interval"][0], 128);
    EXPECT_EQ(view(id, 1, {error / 1000})["targets"][0]["forecast"], nullptr);  // 16 million samples
}

TEST_F(ForecastsTest, OfAJobWithAnErrorTargetKnowItsTiles) {
    JobSpec spec = smallJob(4096);
    spec.stop.relativeError = 0.1;
    spec.stop.minSamples = 16;
    const std::string id = farm.scheduler->submit(spec).job.id;
    renderTo(id, 16);
    const json expected = view(id, 1, {0.1})["forecast"];
    EXPECT_EQ(expected, view(id, 1, {0.1})["targets"][0]["forecast"]);
    EXPECT_NEAR(expected["relativeError"], 0.1, 1e-12);
    // As the tiles would be promoted, not as if all pixels were sampled alike.
    std::vector<TileError> tiles;
    farm.store->read([&](const ConstTables& t) {
        for (const TileErrorRow& row : t.frames.tileErrors(farm.job(id).key, 0)) {
            tiles.push_back(row.error);
            tiles.back().pixels = TileGrid(spec.image).rect(row.tile).area();
        }
    });
    ASSERT_EQ(tiles.size(), 6u);
    const auto promoted = samplesUntil(passSchedule(4096), tiles, 0.1 * 0.1 * 40 * 24);
    ASSERT_TRUE(promoted);
    EXPECT_NEAR(expected["samples"], static_cast<double>(*promoted) / (40 * 24), 1e-9);
}

TEST_F(ForecastsTest, OfAPilotThatEndedGoOnKnowingItsTiles) {
    JobSpec spec = smallJob(16);
    spec.stop.relativeError = 0.1;
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
    farm.store->read([&](const ConstTables& t) {
        const auto outlook = outlookOf(t, *t.frames.find(farm.job(id).key, 0), spec);
        ASSERT_TRUE(outlook);
        EXPECT_EQ(outlook->tiles.size(), 6u);
    });
}

}  // namespace
}  // namespace tilefarm
