#include "worker/agent/agent.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct AgentTest : testing::Test {
    Lease& offer(const std::string& id, const std::string& job = "job1") {
        farm.leases.push_back(fakeLease(farm, id, job));
        return farm.leases.back();
    }
    FinishedResult taken() {
        results.close();
        auto result = results.take();
        return result ? std::move(*result) : FinishedResult{};
    }

    TemporaryFolder folder;
    MemoryFarm farm;
    FakeBackend backend;
    FakeClock clock;
    FakePause pause{clock};
    Standing standing;
    BlobCache cache{folder / "cache", 1 << 20};
    LeaseKeeper keeper{farm, standing, clock};
    ResultQueue results;
    Agent agent{{farm, backend, cache, keeper, results, standing, pause, clock},
                {"host-0", "host", "Fake", "fake 1.0", "0.1.0"},
                5,
                1};
};

TEST_F(AgentTest, RendersALeaseInOneCallForEachSampleRange) {
    offer("a");
    agent.step();
    using Call = FakeBackend::Call;
    EXPECT_THAT(backend.calls, ElementsAre(Call{{0, 1}, {0, 1}}, Call{{0, 1}, {1, 1}}, Call{{0}, {2, 2}}));
    const FinishedResult result = taken();
    EXPECT_EQ(result.leaseId, "a");
    EXPECT_EQ(result.epoch, 5u);
    EXPECT_TRUE(result.whole);
    ASSERT_EQ(result.films.size(), 5u);
    for (size_t i = 0; i < 5; ++i) {  // in the order of the lease
        EXPECT_EQ(result.films[i].tile, fakeLease(farm, "a").passes[i].tile);
        EXPECT_EQ(result.films[i].samples, fakeLease(farm, "a").passes[i].samples);
    }
    EXPECT_NEAR(result.deviceSeconds, 0.05, 1e-12);
    EXPECT_EQ(result.attributes.at("job"), "job1");
    EXPECT_EQ(result.attributes.at("driver"), "fake 1.0");
    EXPECT_EQ(farm.helloed.worker, "host-0");
}

TEST_F(AgentTest, KeepsTheLeaseAliveUntilItsResultIsUploaded) {
    offer("a");
    agent.step();
    clock.advance(Milliseconds(10'000));
    keeper.renewDue();
    EXPECT_THAT(farm.renewed, ElementsAre("a"));
}

TEST_F(AgentTest, KeepsASceneResidentBetweenLeasesOfAJob) {
    offer("a");
    offer("b").passes = {{1, {2, 2}}};
    agent.step();
    agent.step();
    EXPECT_EQ(backend.prepared.size(), 1u);
    EXPECT_EQ(farm.calls[Endpoint::blob], 1);
    EXPECT_EQ(farm.reports.size(), 1u);
}

TEST_F(AgentTest, ReportsOnASceneOnceForEachJob) {
    offer("a", "job1");
    offer("b", "job1").jobId = "job2";  // another job with the same scene and settings
    agent.step();
    agent.step();
    EXPECT_EQ(backend.prepared.size(), 1u);
    ASSERT_EQ(farm.reports.size(), 2u);
    EXPECT_EQ(farm.reports[1].first, "b");
    EXPECT_EQ(farm.reports[1].second.warnings.size(), 1u);
}

TEST_F(AgentTest, MakesAnotherSceneResidentForAnotherJob) {
    offer("a", "job1");
    offer("b", "job2");
    offer("c", "job2").spec.settings.maxBounces = 2;
    for (int i = 0; i < 3; ++i) {
        agent.step();
        results.take();
    }
    EXPECT_EQ(backend.prepared.size(), 3u);
    EXPECT_EQ(farm.calls[Endpoint::blob], 2) << "the last differs only in settings";
}

TEST_F(AgentTest, WaitsAsLongAsTheServerSaysWhenThereIsNoWork) {
    agent.step();
    ASSERT_EQ(pause.waits.size(), 1u);
    EXPECT_GE(pause.waits[0], Milliseconds(1'000));
    EXPECT_LE(pause.waits[0], Milliseconds(1'250));
}

TEST_F(AgentTest, AsksLessAndLessOftenWhileTheServerIsAway) {
    farm.fail(Endpoint::lease, ErrorCode::unavailable, 8);
    offer("a");
    for (int i = 0; i < 9; ++i) agent.step();
    EXPECT_EQ(pause.waits.size(), 8u);
    EXPECT_LT(pause.waits[0], pause.waits[7]);
    EXPECT_EQ(results.size(), 1u);
}

TEST_F(AgentTest, StopsWithTheServersWordsWhenItIsRefused) {
    for (const ErrorCode code : {ErrorCode::unauthorized, ErrorCode::forbidden, ErrorCode::versionRefused}) {
        farm.fail(Endpoint::lease, code);
        agent.run();
        EXPECT_THAT(standing.stopped().value_or(""), HasSubstr("the server says no"));
    }
}

TEST_F(AgentTest, AsksForNoWorkWhileLeasingIsHeld) {
    offer("a");
    standing.holdLeasing(clock.now() + Milliseconds(30'000));
    agent.step();
    EXPECT_EQ(farm.calls[Endpoint::lease], 0);
    EXPECT_THAT(pause.waits, ElementsAre(Milliseconds(30'000)));
    agent.step();
    EXPECT_EQ(results.size(), 1u);
}

TEST_F(AgentTest, ReportsWhatIsWrongWithASceneWithoutTellingWhereItWasKept) {
    backend.prepareFault = ": /nodes/0/mesh is no mesh";
    offer("a");
    agent.step();
    ASSERT_EQ(farm.failures.size(), 1u);
    EXPECT_EQ(farm.failures[0].first, "a");
    EXPECT_EQ(farm.failures[0].second, "scene.gltf: /nodes/0/mesh is no mesh");
    EXPECT_EQ(backend.resets, 1);
    EXPECT_EQ(pause.waits.size(), 1u) << "waits a little after a failure";
    EXPECT_THAT(farm.handedBack, IsEmpty());
}

TEST_F(AgentTest, WaitsLongerAfterEveryFailureAndGoesOn) {
    backend.prepareFault = ": broken";
    for (const char* id : {"a", "b", "c"}) offer(id);
    for (int i = 0; i < 3; ++i) agent.step();
    ASSERT_EQ(pause.waits.size(), 3u);
    EXPECT_LT(pause.waits[0], pause.waits[1]);
    EXPECT_LT(pause.waits[1], pause.waits[2]);
    backend.prepareFault.clear();
    offer("d");
    agent.step();
    EXPECT_EQ(results.size(), 1u);
}

TEST_F(AgentTest, ReportsAnErrorOfTheDeviceWhileRendering) {
    backend.onRender = [] { throw Error(ErrorCode::internal, "the device is lost"); };
    offer("a");
    agent.step();
    ASSERT_EQ(farm.failures.size(), 1u);
    EXPECT_EQ(farm.failures[0].second, "the device is lost");
    backend.onRender = {};
    offer("b");
    agent.step();
    EXPECT_EQ(backend.prepared.size(), 2u) << "starts anew";
    EXPECT_EQ(results.size(), 1u);
}

TEST_F(AgentTest, ReportsAFileOfTheSceneThatIsNotToBeHad) {
    offer("a").spec.scene.files["missing.bin"] = std::string(64, '0');
    agent.step();
    ASSERT_EQ(farm.failures.size(), 1u);
    EXPECT_THAT(farm.failures[0].second, HasSubstr("there is no blob 000"));
}

TEST_F(AgentTest, WaitsForAServerThatGoesAwayWhileItFetchesTheScene) {
    farm.fail(Endpoint::blob, ErrorCode::unavailable, 5);
    offer("a");
    agent.step();
    EXPECT_EQ(pause.waits.size(), 5u);
    EXPECT_EQ(results.size(), 1u);
    EXPECT_THAT(farm.failures, IsEmpty());
}

TEST_F(AgentTest, TriesToReportAFailureUntilTheServerIsBack) {
    backend.prepareFault = ": broken";
    farm.fail(Endpoint::failure, ErrorCode::unavailable, 4);
    offer("a");
    agent.step();
    EXPECT_EQ(farm.failures.size(), 1u);
}

TEST_F(AgentTest, UploadsWhatIsRenderedOfALeaseThatWasLost) {
    offer("a");
    farm.fail(Endpoint::renew, ErrorCode::conflict);
    backend.onRender = [&] {
        clock.advance(Milliseconds(10'000));
        keeper.renewDue();
    };
    agent.step();
    EXPECT_EQ(backend.calls.size(), 1u) << "renders no more than the call it was in";
    const FinishedResult result = taken();
    EXPECT_EQ(result.films.size(), 2u);
    EXPECT_FALSE(result.whole);
}

TEST_F(AgentTest, DropsAllOfAJobThatIsGone) {
    offer("a");
    farm.fail(Endpoint::renew, ErrorCode::gone);
    backend.onRender = [&] {
        clock.advance(Milliseconds(10'000));
        keeper.renewDue();
    };
    agent.step();
    EXPECT_EQ(results.size(), 0u);
    EXPECT_THAT(farm.handedBack, IsEmpty());
    const int dropsBefore = backend.drops;
    agent.step();
    EXPECT_EQ(backend.drops, dropsBefore + 1);
}

TEST_F(AgentTest, AStoppingWorkerFinishesItsCallAndLeavesTheRest) {
    offer("a");
    backend.onRender = [&] { pause.stopped = true; };
    agent.run();
    const FinishedResult result = taken();
    EXPECT_EQ(result.films.size(), 2u);
    EXPECT_FALSE(result.whole) << "so that the Uploader hands the rest back";
}

TEST_F(AgentTest, HandsALeaseBackThatItHasNotBegunWhenItMustStop) {
    offer("a");
    farm.fail(Endpoint::blob, ErrorCode::unavailable, 100);
    pause.onWait = [&] { pause.stopped = true; };
    agent.run();
    EXPECT_THAT(farm.handedBack, ElementsAre("a"));
    EXPECT_THAT(farm.failures, IsEmpty());
}

TEST_F(AgentTest, AServerThatWantsNoReportsGetsPicturesAllTheSame) {
    farm.fail(Endpoint::report, ErrorCode::internal);
    offer("a");
    agent.step();
    EXPECT_EQ(results.size(), 1u);
}

TEST(ResidentKey, DependsOnWhatARendererDependsOnAndNothingElse) {
    JobSpec spec;
    const std::string key = residentKey(spec);
    JobSpec other = spec;
    other.name = "other";
    other.stop.samples = 7;
    other.priority = 1;
    other.frames = {3, 4};
    EXPECT_EQ(residentKey(other), key);
    other = spec;
    other.camera = "Left";
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.settings.seed = 1;
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.image.tileSize = 64;
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.environment.sky.turbidity = 2;
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.lights.emplace_back();
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.materials.emplace_back().roughness = 0.5f;
    EXPECT_NE(residentKey(other), key);
    other = spec;
    other.variant = "dusk";
    EXPECT_NE(residentKey(other), key);
}

}  // namespace
}  // namespace tilefarm
