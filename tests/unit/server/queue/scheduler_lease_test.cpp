#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "server/store/sqlite_job_store.h"
#include "tests/unit/server/queue/scheduler_fixture.h"

namespace tilefarm {
namespace {

uint64_t samplesOf(const Lease& lease) {
    uint64_t samples = 0;
    for (const LeasedPass& pass : lease.passes) {
        samples += TileGrid(lease.spec.image).rect(pass.tile).area() * pass.samples.count;
    }
    return samples;
}

JobSpec largeJob() {
    JobSpec spec = smallJob(64);
    spec.image = {.width = 1024, .height = 1024, .tileSize = 64};
    return spec;
}

TEST_F(SchedulerTest, HasNoLeaseWithoutAJob) {
    const auto answer = scheduler->lease(hello("w"), 5);
    EXPECT_EQ(std::get<NoLease>(answer).retryAfter, config.idleRetry);
}

TEST_F(SchedulerTest, GivesAllTilesOfALevelBeforeTheNext) {
    configure({.mostPixelsPerLease = 4 * 256});
    submit();
    std::vector<LeasedPass> order;
    while (const auto next = tryLease()) order.insert(order.end(), next->passes.begin(), next->passes.end());
    ASSERT_EQ(order.size(), 24u);
    for (size_t i = 0; i < order.size(); ++i) {
        EXPECT_EQ(order[i].tile, i % 6);
        EXPECT_EQ(order[i].samples, passSchedule(8)[i / 6]);
    }
}

TEST_F(SchedulerTest, TakesTheHighestPriorityThenTheOldest) {
    JobSpec spec = smallJob();
    spec.priority = 10;
    const std::string low = submit(spec);
    spec.priority = 90;
    const std::string high = submit(spec), later = submit(spec);
    EXPECT_EQ(lease().jobId, high);
    EXPECT_EQ(lease().jobId, later);
    EXPECT_EQ(lease().jobId, low);
}

TEST_F(SchedulerTest, BeginsModestlyAndThenFollowsTheMeasuredSpeed) {
    submit(largeJob());
    const Lease first = lease();
    EXPECT_LE(samplesOf(first), config.firstLeaseSamples);
    EXPECT_GT(samplesOf(first), config.firstLeaseSamples / 2);
    merge(first, static_cast<double>(samplesOf(first)) / 400'000);  // 400k samples a second
    const Lease second = lease("w", 2);
    EXPECT_NEAR(static_cast<double>(samplesOf(second)), 800'000, 64 * 64 * 2);
}

TEST_F(SchedulerTest, BoundsALeaseByTheSizeOfItsUpload) {
    submit(largeJob());
    const Lease first = lease();
    merge(first, 1e-6);  // as fast as one can be
    uint64_t pixels = 0;
    for (const LeasedPass& pass : lease("w", 10).passes)
        pixels += TileGrid(largeJob().image).rect(pass.tile).area();
    EXPECT_LE(pixels, config.mostPixelsPerLease);
    EXPECT_GT(pixels, config.mostPixelsPerLease / 2);
}

TEST_F(SchedulerTest, GivesAtLeastOnePassHoweverSlowTheWorker) {
    JobSpec spec = largeJob();
    spec.image.tileSize = 1024;
    submit(spec);
    const Lease first = lease();
    EXPECT_EQ(first.passes.size(), 1u);
    merge(first, 1e6);
    EXPECT_EQ(lease("w", 1).passes.size(), 1u);
}

TEST_F(SchedulerTest, KeepsWantedSecondsWithinBounds) {
    submit(largeJob());
    const Lease first = lease();
    merge(first, static_cast<double>(samplesOf(first)) / 100'000);
    EXPECT_LE(samplesOf(lease("w", 1e9)), 1'000'000u + 64 * 64 * 64);
    EXPECT_GE(samplesOf(lease("w", -5)), 90'000u);
}

TEST_F(SchedulerTest, LeavesWorkForOtherWorkersThatAreOnline) {
    submit();  // 24 passes
    tryLease("other");
    scheduler->expire();
    clock.advance(config.leaseTime + Milliseconds(1));
    EXPECT_EQ(lease("w").passes.size(), 6u);  // a half of a fair share of 24 among two
    clock.advance(config.workerOnlineFor);    // now `other` is gone for long
    EXPECT_EQ(lease("w").passes.size(), 24u);
}

TEST_F(SchedulerTest, StartsTheNextFrameWhenTheCurrentIsHandedOut) {
    JobSpec spec = smallJob();
    spec.frames = {.first = -1, .count = 2};
    const std::string id = submit(spec);
    EXPECT_EQ(lease().frame, -1);
    EXPECT_EQ(job(id).framesStarted, 1u);
    EXPECT_EQ(lease().frame, 0);
    EXPECT_FALSE(tryLease());
    clock.advance(config.leaseTime);
    EXPECT_EQ(lease().frame, -1);  // back in the queue, and first
}

TEST_F(SchedulerTest, TakesBackALeaseThatIsNotRenewed) {
    const std::string id = submit();
    const Lease lost = lease("dead");
    clock.advance(config.leaseTime - Milliseconds(1));
    EXPECT_FALSE(tryLease("w"));
    clock.advance(Milliseconds(1));
    const Lease again = lease("w");
    EXPECT_GT(again.epoch, lost.epoch);
    EXPECT_EQ(codeOf([&] { scheduler->renew(lost.id, lost.epoch); }), ErrorCode::conflict);
    EXPECT_EQ(job(id).state, JobState::running);
}

TEST_F(SchedulerTest, KeepsALeaseThatIsRenewed) {
    submit();
    const Lease kept = lease();
    for (int i = 0; i < 10; ++i) {
        clock.advance(config.leaseTime / 3);
        scheduler->renew(kept.id, kept.epoch);
        scheduler->expire();
    }
    EXPECT_EQ(scheduler->openLeases(), 1u);
    EXPECT_EQ(merge(kept).merged, 24u);
}

TEST_F(SchedulerTest, WaitsOneLeaseAfterARestartBeforeItExpiresAny) {
    submit();
    const Lease out = lease();
    clock.advance(config.leaseTime - Milliseconds(1));
    restart();
    clock.advance(config.leaseTime - Milliseconds(1));
    scheduler->expire();
    EXPECT_NO_THROW(scheduler->renew(out.id, out.epoch));
    clock.advance(config.leaseTime);
    scheduler->expire();
    EXPECT_EQ(codeOf([&] { scheduler->renew(out.id, out.epoch); }), ErrorCode::conflict);
}

// All of workers that are alive: each is heard from again. Those that are not: scheduler_loss_test.cpp.
TEST_F(SchedulerTest, NeverFailsWorkForTimeouts) {
    const std::string id = submit();
    for (int i = 0; i < 50; ++i) {
        const Lease late = lease("w" + std::to_string(i));
        clock.advance(config.workerOnlineFor);
        EXPECT_EQ(codeOf([&] { scheduler->expire(), scheduler->renew(late.id, late.epoch); }),
                  ErrorCode::conflict);
    }
    EXPECT_EQ(job(id).state, JobState::running);
    EXPECT_EQ(frame(id).passesQueued + frame(id).passesLeased, frame(id).levelsCreated * 6u);
}

TEST_F(SchedulerTest, PutsHandedBackWorkInTheQueueAtOnce) {
    submit();
    const Lease back = lease();
    scheduler->handBack(back.id, back.epoch);
    EXPECT_EQ(lease("other").passes.front(), back.passes.front());
    EXPECT_EQ(codeOf([&] { scheduler->handBack(back.id, back.epoch); }), ErrorCode::conflict);
}

TEST_F(SchedulerTest, FailsAPassWhenThreeDistinctWorkersReportIt) {
    const std::string id = submit();
    for (const char* worker : {"a", "b", "c"}) scheduler->lease(hello(worker), 5);  // all are online
    clock.advance(config.leaseTime);
    for (const char* worker : {"a", "b", "c"}) {
        EXPECT_EQ(job(id).state, JobState::running);
        const Lease out = lease(worker);
        EXPECT_EQ(out.passes.front().tile, 0u);
        scheduler->reportFailure(out.id, out.epoch, "device lost");
    }
    EXPECT_EQ(job(id).state, JobState::failed);
    ASSERT_EQ(job(id).faults.size(), 1u);
    EXPECT_NE(job(id).faults[0].find("device lost"), std::string::npos);
    EXPECT_FALSE(tryLease("d"));
}

TEST_F(SchedulerTest, GivesAFailedPassToAnotherWorkerFirst) {
    configure({.mostPixelsPerLease = 256});
    submit();
    tryLease("other");
    const Lease out = lease("w");
    scheduler->reportFailure(out.id, out.epoch, "device lost");
    EXPECT_NE(lease("w").passes, out.passes);
    EXPECT_EQ(lease("other").passes, out.passes);
}

TEST_F(SchedulerTest, FailsAJobThatTheOnlyWorkerFailsThrice) {
    const std::string id = submit();
    for (int i = 0; i < 3; ++i) {
        const Lease out = lease();
        EXPECT_EQ(job(id).state, JobState::running) << i;
        scheduler->reportFailure(out.id, out.epoch, "no such camera");
    }
    EXPECT_EQ(job(id).state, JobState::failed);
    EXPECT_EQ(codeOf([&] { scheduler->cancel(id); }), ErrorCode::conflict);
}

TEST_F(SchedulerTest, QuarantinesAWorkerThatFailsWhereOthersSucceed) {
    configure({.mostPixelsPerLease = 256});
    std::vector<std::string> ids;
    for (int i = 0; i < 3; ++i) {
        ids.push_back(submit());
        merge(lease("good"));
        const Lease out = lease("bad");
        scheduler->reportFailure(out.id, out.epoch, "device lost");
        scheduler->pause(ids.back());
    }
    for (const std::string& id : ids) scheduler->resume(id);
    const auto answer = scheduler->lease(hello("bad"), 5);
    EXPECT_NE(std::get<NoLease>(answer).reason.find("quarantined"), std::string::npos);
    EXPECT_TRUE(tryLease("good"));
    restart();
    EXPECT_FALSE(tryLease("bad"));  // it outlives the server
}

TEST_F(SchedulerTest, DoesNotBlameAWorkerForJobsThatNobodyCanRender) {
    for (int i = 0; i < 5; ++i) {
        const std::string id = submit();
        while (job(id).state != JobState::failed) {
            const Lease out = lease();
            scheduler->reportFailure(out.id, out.epoch, "not a scene");
        }
    }
    submit();
    EXPECT_TRUE(tryLease());
}

TEST_F(SchedulerTest, KeepsOneReportPerWorkerAndJob) {
    const std::string id = submit();
    const Lease out = lease();
    scheduler->putReport(out.id, out.epoch, R"({"warnings":[]})");
    store.read([&](const ConstTables& t) { EXPECT_EQ(t.workers.reports(job(id).key).size(), 1u); });
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double kMostMilliseconds = 2000;
#else
constexpr double kMostMilliseconds =
    200;  // about 10 on an idle machine; a scan of the frame takes longer than this
#endif

TEST(SchedulerSpeed, LeasesFromAHugeFrameInMilliseconds) {
    TestFarm farm;
    JobSpec spec = smallJob(4);
    spec.image = {.width = 3840, .height = 2160, .tileSize = 16};
    farm.scheduler->submit(spec);
    farm.lease();                       // makes the frame and its first level
    farm.store->write([&](Tables& t) {  // and here the rest: 130k passes
        FrameRow frame = t.frames.listByState(FrameState::active).at(0);
        for (const SampleRange& level : {SampleRange{1, 1}, SampleRange{2, 2}}) {
            t.passes.insertLevel(frame.job, frame.frame, level, frame.tiles, farm.clock.now());
        }
        frame.levelsCreated = 3;
        frame.passesQueued += 2 * frame.tiles;
        t.frames.update(frame);
    });
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 20; ++i) farm.lease("w" + std::to_string(i));
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
    RecordProperty("millisecondsPerLease", std::to_string(spent.count() / 20));
    EXPECT_LT(spent.count() / 20, kMostMilliseconds);
}

}  // namespace
}  // namespace tilefarm
