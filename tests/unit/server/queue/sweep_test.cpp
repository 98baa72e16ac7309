#include <gtest/gtest.h>

#include "tests/unit/server/queue/scheduler_fixture.h"

namespace tilefarm {
namespace {

std::vector<std::string> names(const std::vector<Violation>& violations) {
    std::vector<std::string> names;
    for (const Violation& violation : violations) names.push_back(violation.invariant);
    return names;
}

TEST_F(SchedulerTest, SweepFindsNothingAmissInAHealthyFarm) {
    configure({.mostPixelsPerLease = 6 * 256});
    submit();
    EXPECT_TRUE(scheduler->sweep().empty());
    merge(lease());
    lease();
    submit();
    EXPECT_TRUE(scheduler->sweep().empty());
    clock.advance(config.leaseTime);
    EXPECT_TRUE(scheduler->sweep().empty());
    EXPECT_EQ(scheduler->openLeases(), 0u);
}

TEST_F(SchedulerTest, SweepFreesPassesWhoseLeaseIsLost) {
    const std::string id = submit();
    const Lease out = lease();
    store.write([&](Tables& t) { t.leases.close(out.epoch, LeaseState::expired); });
    const auto found = scheduler->sweep();
    EXPECT_EQ(found.size(), 24u + 1);
    EXPECT_EQ(found[0].invariant, "leased-pass-has-open-lease");
    EXPECT_TRUE(found[0].repaired);
    EXPECT_EQ(frame(id).passesQueued, 24u);
    EXPECT_TRUE(scheduler->sweep().empty());
}

TEST_F(SchedulerTest, SweepMendsCounts) {
    const std::string id = submit();
    lease();
    store.write([&](Tables& t) {
        FrameRow row = *t.frames.find(job(id).key, 0);
        row.passesLeased = 1;
        row.passesMerged = 3;
        t.frames.update(row);
    });
    EXPECT_EQ(names(scheduler->sweep()), (std::vector<std::string>{"frame-counts-match-passes"}));
    EXPECT_EQ(frame(id).passesLeased, 24u);
    store.write([&](Tables& t) {
        JobRow row = *t.jobs.find(id);
        row.passesMerged = 9;
        t.jobs.update(row);
    });
    EXPECT_EQ(names(scheduler->sweep()), (std::vector<std::string>{"job-counts-match-frames"}));
    EXPECT_EQ(job(id).passesMerged, 0u);
}

TEST_F(SchedulerTest, SweepWatchesOpenLeasesThatNobodyWatches) {
    const std::string id = submit();
    lease();
    store.write([&](Tables& t) {
        t.leases.insert({.epoch = 99, .id = "stray", .worker = "w", .job = job(id).key, .passes = {}});
    });
    EXPECT_EQ(names(scheduler->sweep()), (std::vector<std::string>{"open-lease-is-watched"}));
    EXPECT_TRUE(scheduler->sweep().empty());
}

TEST_F(SchedulerTest, SweepNamesAFrameThatIsStuck) {
    const std::string id = submit();
    lease();
    store.write([&](Tables& t) { t.passes.drop(job(id).key, 0); });
    const auto found = names(scheduler->sweep());
    EXPECT_NE(std::find(found.begin(), found.end(), "active-frame-has-work"), found.end());
}

// Counts what each transaction of the scheduler does to the rows that a sweep forgets.
struct WatchedStore : JobStore {
    JobStore& inner;
    size_t writes = 0, mostForgotten = 0;
    explicit WatchedStore(JobStore& store) : inner(store) {}
    static size_t rowsOf(const Tables& t) { return t.events.list(0, std::nullopt, SIZE_MAX).size(); }
    void write(const std::function<void(Tables&)>& work) override {
        inner.write([&](Tables& t) {
            const size_t before = rowsOf(t);
            work(t);
            mostForgotten = std::max(mostForgotten, before - std::min(before, rowsOf(t)));
        });
        ++writes;
    }
    void read(const std::function<void(const ConstTables&)>& work) const override { inner.read(work); }
};

TEST_F(SchedulerTest, SweepHoldsNobodyUpToLookAtSoundJobs) {
    for (int i = 0; i < 20; ++i) submit();
    WatchedStore watched(store);
    Scheduler over(watched, clock, config);
    EXPECT_TRUE(over.sweep().empty());
    EXPECT_LE(watched.writes, 3u) << "one for each kind of row that grows old, however many jobs there are";
}

TEST_F(SchedulerTest, SweepForgetsManyRowsAFewAtATime) {
    configure({.eventsKept = 2});
    const std::string id = submit();
    store.write([&](Tables& t) {
        for (int i = 0; i < 2000; ++i) t.events.add({0, job(id).key, id, clock.now(), "progress", "{}"});
    });
    WatchedStore watched(store);
    Scheduler over(watched, clock, config);
    over.sweep();
    EXPECT_LE(watched.mostForgotten, 500u);
    store.read([&](const ConstTables& t) { EXPECT_EQ(t.events.list(0, std::nullopt, 5000).size(), 3u); });
}

TEST_F(SchedulerTest, SweepForgetsOldEvents) {
    configure({.eventsKept = 2});
    for (int i = 0; i < 5; ++i) submit();
    scheduler->sweep();
    store.read([&](const ConstTables& t) { EXPECT_EQ(t.events.list(0, std::nullopt, 10).size(), 3u); });
}

}  // namespace
}  // namespace tilefarm
