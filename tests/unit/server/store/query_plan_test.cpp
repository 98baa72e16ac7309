#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "server/store/sqlite_connection.h"
#include "server/store/sqlite_schema.h"
#include "server/store/sqlite_tables.h"
#include "sql/events.h"
#include "sql/frames.h"
#include "sql/jobs.h"
#include "sql/leases.h"
#include "sql/passes.h"
#include "sql/studies.h"
#include "sql/workers.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr TimePoint kNow{Milliseconds{1'700'000'000'000}};
constexpr uint32_t kTiles = 64;

// Statements that look at a whole table or index, and why they may.
const std::map<std::string, const char*> kMayScan{
    {sql::jobs::totals, "metrics; a row per state"},
    {sql::jobs::leasable, "holds the jobs asked for and no others"},
    {sql::passes::held, "at start, all are wanted"},
    {sql::passes::oldestQueued, "the first entry of an index that holds no others"},
    {sql::passes::leasedWithoutLease, "every minute; holds the passes on loan and no others"},
    {sql::leases::open, "holds the leases asked for and no others"},
    {sql::leases::lost, "at start; holds the leases asked for and no others"},
    {sql::leases::lastEpoch, "a row per table"},
    {sql::events::lastId, "a row per table"},
    {sql::studies::open, "holds the studies asked for and no others"},
    {sql::workers::list, "all are wanted"},
    {sql::workers::forgetSeenBefore, "every minute; workers are few"},
};

// Every query of the store, prepared as the store prepares it, over tables that were never ANALYZEd: what
// a farm has, and where SQLite knows the schema but no counts.
class QueryPlan : public testing::Test {
protected:
    QueryPlan() {
        migrate(connection_.db());
        SQLite::Transaction once(connection_.db());
        fill();
        callEverything();
        once.commit();
    }

    std::vector<std::string> plan(const std::string& sql) {
        SQLite::Statement explain(connection_.db(), "EXPLAIN QUERY PLAN " + sql);
        std::vector<std::string> steps;
        while (explain.executeStep()) steps.push_back(explain.getColumn("detail").getString());
        return steps;
    }
    Connection& connection() { return connection_; }

private:
    void fill() {
        Tables t = tables_.tables();
        JobRow row;
        row.outlineJson = "{}";
        row.passes = row.frames = row.pixelSamples = 1;
        for (int i = 0; i < 100; ++i) {
            row.id = "j" + std::to_string(i);
            job_ = t.jobs.insert(row, "{}");
        }
        FrameRow frame;
        frame.job = job_;
        frame.levels = 1;
        frame.tiles = kTiles;
        t.frames.insert(frame);
        t.passes.insertLevel(job_, 0, {0, 1}, kTiles, kNow);
    }

    // A method that is not called here goes unseen: add each new one.
    void callEverything() {
        Tables t = tables_.tables();
        callJobs(t.jobs);
        callFrames(t.frames);
        callLeases(t.leases);
        callPasses(t.passes);
        callWorkers(t.workers);
        callStudies(t.studies);
        t.events.add({0, job_, "j", kNow, "job", "{}"});
        t.events.list(0, std::nullopt, 1);
        t.events.list(0, job_, 1);
        t.events.lastId();
        t.events.forgetBelow(1, 10);
    }
    void callJobs(JobTable& jobs) {
        jobs.find("j1");
        jobs.findByIdempotencyKey("key");
        jobs.list({});
        jobs.list({.state = JobState::queued});
        jobs.forEachLeasable([](JobKey) { return true; });
        jobs.totals();
        jobs.oldestQueued();
        jobs.spec(job_);
        jobs.update(*jobs.find(job_));
    }
    void callFrames(FrameTable& frames) {
        frames.list(job_);
        frames.listByState(FrameState::finishing);
        frames.listActive(job_);
        frames.listWithWork(job_);
        frames.countActive(job_);
        frames.update(*frames.find(job_, 0));
        frames.tiles(job_, 0);
        frames.update(*frames.tile(job_, 0, 1));
        frames.level(job_, 0, 1);
        frames.levels(job_, 0);
        frames.put(LevelRow{.job = job_, .samples = 1, .relativeError = {}, .deviceSeconds = {}});
        frames.dropTiles(job_, 1);
        frames.dropTileErrors(job_, 1);
    }
    void callPasses(PassTable& passes) {
        passes.lowestQueued(job_, 0, 0);
        passes.claim({.job = job_, .frame = 0, .epoch = 1, .level = {0, 1}, .limit = 2, .worker = "w"});
        passes.counts(job_, 0);
        passes.leasedWithoutLease(10);
        passes.held();
        passes.heldOf(job_, 0, 1);
        passes.isHeld("file");
        passes.oldestQueued();
        passes.update(*passes.find(job_, 0, 1, 0));
        passes.release(1, kNow);
        passes.drop(job_, 0, 1);
    }
    void callLeases(LeaseTable& leases) {
        leases.insert({.epoch = 1, .id = "l", .worker = "w", .job = job_, .granted = kNow, .passes = {}});
        leases.find("l");
        leases.open();
        leases.lastEpoch();
        leases.close(1, LeaseState::expired);
        leases.forgetClosedBefore(kNow, 10);
        leases.addFailure({job_, 0, 0, 0, "w", "message", 1});
        leases.failures(job_, 0, 0, 0);
        leases.jobsOnlyThisWorkerFailed("w");
        leases.lost();
        leases.setLoss(1, Loss::counted);
        leases.addDeaths(*leases.find("l"), 1);
        leases.addDeaths({.id = {}, .worker = {}, .job = job_, .passes = {{0, {0, 1}}}}, 1);
        leases.deadly(job_, 3);
        leases.forgetDeaths(job_);
    }
    void callWorkers(WorkerTable& workers) {
        workers.list();
        workers.put({{"w", "host", "device", "driver", "1"}, WorkerState::online, "", kNow, kNow});
        workers.forgetSeenBefore(kNow);
        workers.addContribution({job_, "w", 1, 1, 1});
        workers.contributions(job_);
        workers.putReport({job_, "w", "{}"});
        workers.reports(job_);
    }
    static void callStudies(StudyTable& studies) {
        const int64_t key = studies.insert({.id = "s", .requestJson = "{}", .finished = {}, .fault = {}});
        studies.update(*studies.find("s"));
        studies.list(INT64_MAX, 10);
        studies.open();
        studies.putCell({key, 0, "{}", "{}"});
        studies.cells(key);
        studies.cell(key, 0);
    }

    TemporaryFolder folder_;
    Connection connection_{folder_ / "db", true};
    SqliteTables tables_{connection_};
    JobKey job_ = 0;
};

TEST_F(QueryPlan, LooksAtNoMoreThanIsAskedFor) {
    ASSERT_GT(connection().prepared().size(), 50u);
    for (const std::string& sql : connection().prepared()) {
        for (const std::string& step : plan(sql)) {
            EXPECT_THAT(step, testing::Not(HasSubstr("TEMP B-TREE"))) << sql;
            const bool scans = step.starts_with("SCAN ") && step != "SCAN t" && step != "SCAN CONSTANT ROW";
            EXPECT_TRUE(!scans || kMayScan.contains(sql)) << sql << "\n  " << step;
        }
    }
}

TEST_F(QueryPlan, TakesTheIndexMadeForEachHotQuery) {
    EXPECT_THAT(plan(sql::jobs::leasable), testing::ElementsAre("SCAN jobs USING INDEX jobs_leasable"));
    EXPECT_THAT(
        plan(sql::passes::heldOf),
        testing::ElementsAre("SEARCH passes USING INDEX passes_held_of_tile (job=? AND frame=? AND tile=?)"));
    EXPECT_THAT(plan(sql::passes::isHeld), Contains(HasSubstr("INDEX passes_held (held_file=?)")));
    EXPECT_THAT(plan(sql::jobs::oldestQueued), Contains(HasSubstr("INDEX jobs_by_state (state=?)")));
    EXPECT_THAT(plan(sql::frames::listWithWork),
                testing::ElementsAre("SEARCH frames USING INDEX frames_with_work (job=?)"));
    EXPECT_THAT(plan(sql::passes::oldestQueued), testing::ElementsAre(HasSubstr("INDEX passes_oldest")));
    EXPECT_THAT(plan(sql::passes::claim), Contains(HasSubstr("INDEX passes_queued")));
    EXPECT_THAT(plan(sql::passes::release), Contains(HasSubstr("INDEX passes_leased")));
    EXPECT_THAT(plan(sql::passes::lowestQueued), Contains(HasSubstr("INDEX passes_queued")));
    EXPECT_THAT(plan(sql::passes::find),
                Contains(HasSubstr("PRIMARY KEY (job=? AND frame=? AND first_sample=? AND tile=?)")));
    EXPECT_THAT(plan(sql::passes::update),
                Contains(HasSubstr("(job=? AND frame=? AND tile=? AND first_sample=?)")));
    EXPECT_THAT(plan(sql::leases::forgetClosedBefore),
                Contains(HasSubstr("INDEX leases_closed (granted<?)")));
}

}  // namespace
}  // namespace tilefarm
