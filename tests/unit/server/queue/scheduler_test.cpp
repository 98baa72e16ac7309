#include "server/queue/scheduler.h"

#include "tests/unit/server/queue/scheduler_fixture.h"

namespace tilefarm {
namespace {

TEST_F(SchedulerTest, MakesNoRowsForAJobThatNobodyWorksOn) {
    const std::string id = submit();
    EXPECT_EQ(job(id).state, JobState::queued);
    EXPECT_EQ(job(id).passes, 24u);
    store.read([&](const ConstTables& t) {
        EXPECT_TRUE(t.frames.list(job(id).key).empty());
        EXPECT_EQ(t.passes.oldestQueued(), std::nullopt);
    });
}

TEST_F(SchedulerTest, StartsAJobWithItsFirstLease) {
    const std::string id = submit();
    lease();
    EXPECT_EQ(job(id).state, JobState::running);
    EXPECT_EQ(job(id).started, clock.now());
    EXPECT_EQ(frame(id).tiles, 6u);
}

TEST_F(SchedulerTest, GivesTheSameJobForARepeatedKey) {
    const auto first = scheduler->submit(smallJob(), "key", "body");
    const auto second = scheduler->submit(smallJob(), "key", "body");
    EXPECT_TRUE(first.created);
    EXPECT_FALSE(second.created);
    EXPECT_EQ(first.job.id, second.job.id);
    EXPECT_EQ(codeOf([&] { scheduler->submit(smallJob(), "key", "other body"); }), ErrorCode::conflict);
    EXPECT_NE(scheduler->submit(smallJob(), "other", "body").job.id, first.job.id);
}

TEST_F(SchedulerTest, CancelsEverythingThatIsOut) {
    const std::string id = submit();
    const Lease out = lease();
    EXPECT_EQ(scheduler->cancel(id).state, JobState::canceled);
    EXPECT_EQ(codeOf([&] { scheduler->renew(out.id, out.epoch); }), ErrorCode::gone);
    EXPECT_EQ(codeOf([&] { scheduler->resultTarget(out.id, out.epoch); }), ErrorCode::gone);
    EXPECT_EQ(scheduler->openLeases(), 0u);
    EXPECT_FALSE(tryLease());
    EXPECT_EQ(scheduler->cancel(id).state, JobState::canceled);  // asked again
    EXPECT_EQ(codeOf([&] { scheduler->resume(id); }), ErrorCode::conflict);
}

TEST_F(SchedulerTest, HandsOutNothingOfAPausedJobButTakesWhatIsOut) {
    configure({.mostPixelsPerLease = 6 * 256});
    const std::string id = submit();
    const Lease out = lease();
    scheduler->pause(id);
    EXPECT_FALSE(tryLease());
    EXPECT_EQ(merge(out).merged, 6u);
    EXPECT_EQ(scheduler->resume(id).state, JobState::running);
    EXPECT_TRUE(tryLease());
}

TEST_F(SchedulerTest, ResumesAJobThatHadNotBegunAsQueued) {
    const std::string id = submit();
    EXPECT_EQ(scheduler->pause(id).state, JobState::paused);
    EXPECT_EQ(scheduler->resume(id).state, JobState::queued);
    EXPECT_EQ(scheduler->resume(id).state, JobState::queued);
}

TEST_F(SchedulerTest, CompletesAPausedJobWhoseLastPassComesIn) {
    const std::string id = submit();
    const Lease all = lease();
    scheduler->pause(id);
    merge(all);
    EXPECT_EQ(frame(id).state, FrameState::finishing);
    scheduler->frameWritten(job(id).key, 0, std::string(64, 'e'), 100);
    EXPECT_EQ(job(id).state, JobState::completed);
    EXPECT_EQ(job(id).finished, clock.now());
    EXPECT_EQ(codeOf([&] { scheduler->cancel(id); }), ErrorCode::conflict);
}

TEST_F(SchedulerTest, CountsAFrameWrittenTwiceOnce) {
    const std::string id = submit();
    merge(lease());
    for (int i = 0; i < 2; ++i) scheduler->frameWritten(job(id).key, 0, std::string(64, 'e'), 100);
    EXPECT_EQ(job(id).framesDone, 1u);
}

TEST_F(SchedulerTest, ForgetsTheRowsOfACompletedFrame) {
    const std::string id = submit();
    merge(lease());
    scheduler->frameWritten(job(id).key, 0, std::string(64, 'e'), 100);
    store.read([&](const ConstTables& t) {
        EXPECT_TRUE(t.frames.tiles(job(id).key, 0).empty());
        EXPECT_EQ(t.passes.counts(job(id).key, 0), PassCounts{});
        EXPECT_EQ(t.frames.levels(job(id).key, 0).size(), 4u);  // the error curve stays
    });
}

TEST_F(SchedulerTest, WritesAnEventForEachChangeOfState) {
    int told = 0;
    scheduler = std::make_unique<Scheduler>(store, clock, config, [&] { ++told; });
    const std::string id = submit();
    merge(lease());
    scheduler->frameWritten(job(id).key, 0, std::string(64, 'e'), 100);
    std::vector<std::string> types;
    store.read([&](const ConstTables& t) {
        for (const EventRow& event : t.events.list(0, std::nullopt, 100)) types.push_back(event.type);
    });
    EXPECT_EQ(types, (std::vector<std::string>{"job", "frame", "job", "frame", "progress", "frame", "job"}));
    EXPECT_EQ(told, 4);  // once per transaction
}

TEST_F(SchedulerTest, NamesUnknownJobsAndLeases) {
    EXPECT_EQ(codeOf([&] { scheduler->cancel("none"); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { scheduler->renew("none", 1); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { scheduler->resultTarget("none", 1); }), ErrorCode::notFound);
    submit();
    const Lease out = lease();
    EXPECT_EQ(codeOf([&] { scheduler->renew(out.id, out.epoch + 1); }), ErrorCode::conflict);
    EXPECT_EQ(codeOf([&] { scheduler->resultTarget(out.id, out.epoch + 1); }), ErrorCode::conflict);
}

}  // namespace
}  // namespace tilefarm
