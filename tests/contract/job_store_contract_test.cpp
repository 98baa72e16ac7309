// Long because one suite holds every table of a store to what it promises.
#include <gtest/gtest.h>

#include <array>

#include "server/store/sqlite_job_store.h"
#include "tests/contract/backend_name.h"
#include "tests/support/expect_error.h"
#include "tests/support/memory_job_store.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using MakeStore = std::function<std::unique_ptr<JobStore>(const TemporaryFolder&)>;

constexpr TimePoint kNow{Milliseconds{1'700'000'000'000}};
constexpr std::array kJobStates{JobState::queued,    JobState::running, JobState::paused,
                                JobState::completed, JobState::failed,  JobState::canceled};
constexpr std::array kPassStates{PassState::queued, PassState::leased, PassState::merged, PassState::failed};

JobRow jobRow(const std::string& id, int32_t priority = 50) {
    JobRow row;
    row.id = id;
    row.priority = priority;
    row.outlineJson = "{}";
    row.created = kNow;
    row.passes = 100;
    row.pixelSamples = 1000;
    row.frames = 2;
    return row;
}

class JobStoreContract : public testing::TestWithParam<MakeStore> {
protected:
    void write(const std::function<void(Tables&)>& work) { store->write(work); }
    void read(const std::function<void(const ConstTables&)>& work) { store->read(work); }

    JobKey addJob(const JobRow& row) {
        JobKey key = 0;
        write([&](Tables& t) { key = t.jobs.insert(row, "{\"of\":\"" + row.id + "\"}"); });
        return key;
    }
    // A job with a frame of `tiles` tiles, each with one queued pass of sample 0.
    JobKey addFrame(uint32_t tiles, const std::string& id = "a") {
        const JobKey job = addJob(jobRow(id));
        write([&](Tables& t) {
            FrameRow frame;
            frame.job = job;
            frame.levels = 3;
            frame.tiles = tiles;
            t.frames.insert(frame);
            t.passes.insertLevel(job, 0, {0, 1}, tiles, kNow);
        });
        return job;
    }
    std::vector<LeasedPass> claim(JobKey job, uint64_t epoch, size_t limit, const std::string& worker = "w",
                                  size_t online = 1) {
        std::vector<LeasedPass> taken;
        write([&](Tables& t) {
            taken = t.passes.claim({.job = job,
                                    .frame = 0,
                                    .epoch = epoch,
                                    .level = {0, 1},
                                    .limit = limit,
                                    .worker = worker,
                                    .onlineWorkers = online});
        });
        return taken;
    }
    PassCounts counts(JobKey job) {
        PassCounts counts;
        read([&](const ConstTables& t) { counts = t.passes.counts(job, 0); });
        return counts;
    }
    PassRow pass(JobKey job, uint32_t tile) {
        PassRow row;
        read([&](const ConstTables& t) { row = t.passes.find(job, 0, tile, 0).value(); });
        return row;
    }

    TemporaryFolder folder;
    std::unique_ptr<JobStore> store = GetParam()(folder);
};

TEST_P(JobStoreContract, GivesBackAJobWithAllItSays) {
    JobRow row = jobRow("a", 70);
    row.idempotencyKey = "key";
    row.bodyDigest = "digest";
    row.faults = {"one", "two words"};
    const JobKey key = addJob(row);
    row = jobRow("a", 70);
    write([&](Tables& t) {
        JobRow job = *t.jobs.find(key);
        job.state = JobState::running;
        job.started = kNow;
        job.passesMerged = 3;
        job.pixelSamplesMerged = 7;
        job.relativeError = 0.25;
        job.deviceSeconds = 1.5;
        job.rejectedPaths = 11;
        job.truncatedPaths = 12;
        job.truncatedThroughput = 0.5;
        job.clampedSamples = 13;
        job.clampedLuminance = 0.75;
        job.keptLuminance = 2.25;
        job.lightsBehindGlass = 14;
        job.faultSamples = {"0 1 2 3", "4 5 6 7"};
        job.suspectFrame = -3;
        job.diedOn = {"one", "two"};
        job.setAside = "why";
        t.jobs.update(job);
    });
    read([&](const ConstTables& t) {
        const JobRow found = t.jobs.findByIdempotencyKey("key").value();
        EXPECT_EQ(found.key, key);
        EXPECT_EQ(found.state, JobState::running);
        EXPECT_EQ(found.priority, 70);
        EXPECT_EQ(found.started, kNow);
        EXPECT_EQ(found.finished, std::nullopt);
        EXPECT_EQ(found.passesMerged, 3u);
        EXPECT_EQ(found.pixelSamples, 1000u);
        EXPECT_EQ(found.suspectFrame, -3);
        EXPECT_EQ(found.diedOn, (std::vector<std::string>{"one", "two"}));
        EXPECT_EQ(found.setAside, "why");
        EXPECT_EQ(found.pixelSamplesMerged, 7u);
        EXPECT_EQ(found.relativeError, 0.25);
        EXPECT_EQ(found.deviceSeconds, 1.5);
        EXPECT_EQ(found.faults, (std::vector<std::string>{"one", "two words"}));
        EXPECT_EQ(found.rejectedPaths, 11u);
        EXPECT_EQ(found.truncatedPaths, 12u);
        EXPECT_EQ(found.truncatedThroughput, 0.5);
        EXPECT_EQ(found.clampedSamples, 13u);
        EXPECT_EQ(found.clampedLuminance, 0.75);
        EXPECT_EQ(found.keptLuminance, 2.25);
        EXPECT_EQ(found.lightsBehindGlass, 14u);
        EXPECT_EQ(found.outlineJson, "{}");
        EXPECT_EQ(t.jobs.spec(key), "{\"of\":\"a\"}");
        EXPECT_EQ(found.faultSamples, (std::vector<std::string>{"0 1 2 3", "4 5 6 7"}));
        EXPECT_EQ(t.jobs.find("a")->key, key);
        EXPECT_FALSE(t.jobs.find("b"));
        EXPECT_FALSE(t.jobs.findByIdempotencyKey(""));
    });
}

TEST_P(JobStoreContract, UndoesATransactionThatThrows) {
    const JobKey job = addFrame(2);
    EXPECT_EQ(codeOf([&] {
                  write([&](Tables& t) {
                      t.jobs.insert(jobRow("b"), "{}");
                      t.passes.claim(
                          {.job = job, .frame = 0, .epoch = 1, .level = {0, 1}, .limit = 2, .worker = "w"});
                      throw Error(ErrorCode::gone, "stop");
                  });
              }),
              ErrorCode::gone);
    read([&](const ConstTables& t) { EXPECT_FALSE(t.jobs.find("b")); });
    EXPECT_EQ(counts(job), (PassCounts{.queued = 2}));
}

TEST_P(JobStoreContract, ShowsReadersTheStateBeforeAWriterThatIsUnderWay) {
    addJob(jobRow("a"));
    write([&](Tables& t) {
        t.jobs.insert(jobRow("b"), "{}");
        read([&](const ConstTables& view) { EXPECT_FALSE(view.jobs.find("b")); });
    });
    read([&](const ConstTables& t) { EXPECT_TRUE(t.jobs.find("b")); });
}

TEST_P(JobStoreContract, RefusesASecondJobOfAnIdOrKey) {
    JobRow row = jobRow("a");
    row.idempotencyKey = "key";
    addJob(row);
    EXPECT_EQ(codeOf([&] { addJob(jobRow("a")); }), ErrorCode::conflict);
    row.id = "b";
    EXPECT_EQ(codeOf([&] { addJob(row); }), ErrorCode::conflict);
}

TEST_P(JobStoreContract, ListsNewestFirstAPageAtATime) {
    for (const char* id : {"a", "b", "c"}) addJob(jobRow(id));
    read([&](const ConstTables& t) {
        const auto page = t.jobs.list({.state = {}, .limit = 2});
        ASSERT_EQ(page.size(), 2u);
        EXPECT_EQ(page[0].id, "c");
        EXPECT_EQ(page[1].id, "b");
        EXPECT_EQ(t.jobs.list({.state = {}, .before = page[1].key, .limit = 2}).at(0).id, "a");
        EXPECT_TRUE(t.jobs.list({.state = JobState::failed}).empty());
        EXPECT_EQ(t.jobs.totals().at(JobState::queued).jobs, 3u);
    });
}

TEST_P(JobStoreContract, VisitsJobsByPriorityThenAge) {
    for (int i = 0; i < 20; ++i) addJob(jobRow("low" + std::to_string(i), 10));
    addJob(jobRow("high", 90));
    std::vector<JobKey> order;
    read([&](const ConstTables& t) {
        t.jobs.forEachLeasable([&](JobKey key) {
            order.push_back(key);
            return order.size() < 19;
        });
    });
    ASSERT_EQ(order.size(), 19u);
    EXPECT_EQ(order[0], 21);
    EXPECT_TRUE(std::is_sorted(order.begin() + 1, order.end()));
    EXPECT_EQ(order[1], 1);
}

TEST_P(JobStoreContract, PassesOverJobsAndFramesThatAreWhollyOnLoan) {
    const JobKey job = addFrame(2);  // 2 passes of 3 levels are counted below, as the scheduler does
    const auto leasable = [&] {
        std::vector<JobKey> keys;
        read([&](const ConstTables& t) {
            t.jobs.forEachLeasable([&](JobKey key) {
                keys.push_back(key);
                return true;
            });
        });
        return keys;
    };
    const auto move = [&](uint64_t queued, uint64_t leased, uint32_t levels) {
        write([&](Tables& t) {
            FrameRow frame = *t.frames.find(job, 0);
            frame.passesQueued = queued;
            frame.passesLeased = leased;
            frame.levelsCreated = levels;
            t.frames.update(frame);
        });
    };
    const auto framesWithWork = [&] {
        size_t frames = 0;
        read([&](const ConstTables& t) { frames = t.frames.listWithWork(job).size(); });
        return frames;
    };
    write([&](Tables& t) {
        JobRow row = *t.jobs.find(job);
        row.passesMerged = row.passes - 6;
        t.jobs.update(row);
    });
    move(6, 0, 3);
    EXPECT_EQ(leasable(), std::vector{job});
    EXPECT_EQ(framesWithWork(), 1u);
    move(0, 6, 3);
    EXPECT_TRUE(leasable().empty());
    EXPECT_EQ(framesWithWork(), 0u);
    move(0, 6, 2);
    EXPECT_EQ(framesWithWork(), 1u) << "a level is still to come";
    move(1, 5, 3);
    EXPECT_EQ(leasable(), std::vector{job});
    EXPECT_EQ(framesWithWork(), 1u);
    read([&](const ConstTables& t) { EXPECT_EQ(t.frames.countActive(job), 1u); });
}

TEST_P(JobStoreContract, KeepsTheTotalsOfEveryState) {
    const JobKey job = addFrame(4, "a");
    addJob(jobRow("b"));
    write([&](Tables& t) {
        FrameRow frame = *t.frames.find(job, 0);
        frame.passesQueued = 3;
        frame.passesLeased = 1;
        t.frames.update(frame);
        frame.frame = 1;
        frame.passesQueued = 2;
        t.frames.insert(frame);
        JobRow row = *t.jobs.find(job);
        EXPECT_EQ(row.passesQueued, 5u);
        EXPECT_EQ(row.passesLeased, 2u);
        row.passesQueued = row.passesLeased = 99;  // an update does not take them from the row
        row.passesMerged = 7;
        row.state = JobState::running;
        t.jobs.update(row);
        row.passes = 80;  // a job that decides on the way needs fewer
        t.jobs.update(row);
    });
    read([&](const ConstTables& t) {
        const auto totals = t.jobs.totals();
        EXPECT_EQ(totals.at(JobState::running), (JobTotals{1, 80, 7, 5, 2}));
        EXPECT_EQ(totals.at(JobState::queued), (JobTotals{1, 100, 0, 0, 0}));
        EXPECT_EQ(t.jobs.oldestQueued(), kNow);
    });
    write([&](Tables& t) {
        JobRow row = *t.jobs.find("b");
        row.state = JobState::canceled;
        t.jobs.update(row);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.jobs.totals().at(JobState::canceled).jobs, 1u);
        EXPECT_EQ(t.jobs.oldestQueued(), std::nullopt);
    });
}

TEST_P(JobStoreContract, AllowsExactlyTheMovesOfJobsInTheTable) {
    for (const JobState from : kJobStates) {
        for (const JobState to : kJobStates) {
            JobRow row = jobRow(std::string(toString(from)) + "-" + std::string(toString(to)));
            row.state = from;
            row.key = addJob(row);
            row.state = to;
            const auto move = [&] { write([&](Tables& t) { t.jobs.update(row); }); };
            if (from == to || canMove(from, to))
                EXPECT_NO_THROW(move()) << row.id;
            else
                EXPECT_EQ(codeOf(move), ErrorCode::conflict) << row.id;
        }
    }
}

TEST_P(JobStoreContract, AllowsExactlyTheMovesOfPassesInTheTable) {
    const JobKey job = addFrame(static_cast<uint32_t>(kPassStates.size() * kPassStates.size()));
    // The moves that lead from queued to each state.
    const std::map<PassState, std::vector<PassState>> ways{
        {PassState::queued, {}},
        {PassState::leased, {PassState::leased}},
        {PassState::merged, {PassState::merged}},
        {PassState::failed, {PassState::leased, PassState::failed}}};
    uint32_t tile = 0;
    for (const PassState from : kPassStates) {
        for (const PassState to : kPassStates) {
            PassRow row = pass(job, tile++);
            row.epoch = 1;
            const auto move = [&](PassState state) {
                row.state = state;
                write([&](Tables& t) { t.passes.update(row); });
            };
            for (const PassState step : ways.at(from)) move(step);
            if (from == to || canMove(from, to))
                EXPECT_NO_THROW(move(to)) << toString(from) << toString(to);
            else
                EXPECT_EQ(codeOf([&] { move(to); }), ErrorCode::conflict) << toString(from) << toString(to);
        }
    }
}

TEST_P(JobStoreContract, LeasesAPassToOneWorkerOnly) {
    const JobKey job = addFrame(3);
    EXPECT_EQ(claim(job, 1, 2), (std::vector<LeasedPass>{{0, {0, 1}}, {1, {0, 1}}}));
    EXPECT_EQ(claim(job, 2, 2), (std::vector<LeasedPass>{{2, {0, 1}}}));
    EXPECT_TRUE(claim(job, 3, 2).empty());
    EXPECT_EQ(pass(job, 2).epoch, 2u);
    EXPECT_EQ(counts(job), (PassCounts{.leased = 3}));
}

TEST_P(JobStoreContract, ReleasesOnlyTheLeasedPassesOfALease) {
    const JobKey job = addFrame(3);
    claim(job, 1, 2);
    claim(job, 2, 1);
    write([&](Tables& t) {
        PassRow merged = *t.passes.find(job, 0, 0, 0);
        merged.state = PassState::merged;
        t.passes.update(merged);
        EXPECT_EQ(t.passes.release(1, kNow), 1u);
    });
    EXPECT_EQ(counts(job), (PassCounts{.queued = 1, .leased = 1, .merged = 1}));
    EXPECT_EQ(claim(job, 3, 5), (std::vector<LeasedPass>{{1, {0, 1}}}));
}

TEST_P(JobStoreContract, LeavesAFailedPassToOthersUntilAllHaveFailedIt) {
    const JobKey job = addFrame(2);
    write([&](Tables& t) { t.leases.addFailure({job, 0, 0, 0, "w", "lost device", 1}); });
    EXPECT_EQ(claim(job, 1, 5, "w", 2), (std::vector<LeasedPass>{{1, {0, 1}}}));
    EXPECT_EQ(claim(job, 2, 5, "w", 1), (std::vector<LeasedPass>{{0, {0, 1}}}));  // there is nobody else
}

TEST_P(JobStoreContract, HoldsOnePassPerTileAndFirstSample) {
    const JobKey job = addFrame(2);
    EXPECT_EQ(codeOf([&] { write([&](Tables& t) {
                               t.passes.insertLevel(job, 0, {0, 1}, 2, kNow);
                           }); }),
              ErrorCode::conflict);
}

TEST_P(JobStoreContract, FindsTheLowestLevelThatHasQueuedPasses) {
    const JobKey job = addFrame(2);
    write([&](Tables& t) {
        t.passes.insertLevel(job, 0, {1, 1}, 2, kNow + Milliseconds(5));
        EXPECT_EQ(t.passes.lowestQueued(job, 0, 0), 0u);
        EXPECT_EQ(t.passes.lowestQueued(job, 0, 1), 1u);
        EXPECT_EQ(t.passes.lowestQueued(job, 0, 2), std::nullopt);
        EXPECT_EQ(t.passes.oldestQueued(), kNow);
    });
    claim(job, 1, 2);
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.passes.lowestQueued(job, 0, 0), 1u);
        EXPECT_EQ(t.passes.oldestQueued(), kNow + Milliseconds(5));
    });
}

TEST_P(JobStoreContract, DropsPassesBelowASample) {
    const JobKey job = addFrame(2);
    write([&](Tables& t) {
        t.passes.insertLevel(job, 0, {1, 1}, 2, kNow);
        t.passes.drop(job, 0, 1);
    });
    EXPECT_EQ(counts(job), (PassCounts{.queued = 2}));
    read([&](const ConstTables& t) { EXPECT_FALSE(t.passes.find(job, 0, 0, 0)); });
}

TEST_P(JobStoreContract, RemembersWhereEarlyPassesLie) {
    const JobKey job = addFrame(2);
    write([&](Tables& t) {
        PassRow row = *t.passes.find(job, 0, 1, 0);
        row.state = PassState::merged;
        row.held = HeldPass{"file", 64};
        t.passes.update(row);
    });
    read([&](const ConstTables& t) {
        ASSERT_EQ(t.passes.held().size(), 1u);
        EXPECT_EQ(t.passes.heldOf(job, 0, 1).at(0).held->offset, 64u);
        EXPECT_TRUE(t.passes.heldOf(job, 0, 0).empty());
        EXPECT_TRUE(t.passes.isHeld("file"));
        EXPECT_FALSE(t.passes.isHeld("fil"));
    });
    write([&](Tables& t) {
        PassRow row = *t.passes.find(job, 0, 1, 0);
        row.held.reset();
        t.passes.update(row);
    });
    read([&](const ConstTables& t) { EXPECT_FALSE(t.passes.isHeld("file")); });
}

TEST_P(JobStoreContract, MakesTilesWithTheFrameAndNeverLosesTheirSamples) {
    const JobKey job = addFrame(3);
    write([&](Tables& t) {
        EXPECT_EQ(t.frames.tiles(job, 0).size(), 3u);
        t.frames.update(TileRow{.job = job, .frame = 0, .tile = 1, .slot = 1, .mergedSamples = 4});
    });
    EXPECT_EQ(
        codeOf([&] {
            write([&](Tables& t) { t.frames.update(TileRow{.job = job, .tile = 1, .mergedSamples = 3}); });
        }),
        ErrorCode::conflict);
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.frames.tile(job, 0, 1)->mergedSamples, 4u);
        EXPECT_EQ(t.frames.tile(job, 0, 1)->slot, 1u);
        EXPECT_FALSE(t.frames.tile(job, 0, 3));
    });
    write([&](Tables& t) { t.frames.dropTiles(job, 0); });
    read([&](const ConstTables& t) { EXPECT_TRUE(t.frames.tiles(job, 0).empty()); });
}

TEST_P(JobStoreContract, KeepsWhatTilesMeasure) {
    const JobKey job = addFrame(3);
    TileErrorRow row{
        .job = job, .frame = 0, .tile = 2, .error = {.samples = 8, .variance = 0.5, .earlier = 0.25}};
    row.errorSquares = 3;
    row.borrowedVariance = 0.125;
    row.errorTail.add(WorstPixel{3, 4, 0.1});
    row.droppedSamples = 5;
    write([&](Tables& t) {
        t.frames.put(row);
        t.frames.put(TileErrorRow{.job = job, .frame = 0, .tile = 0, .error = {.samples = 4}});
        row.error.samples = 16;
        t.frames.put(row);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.frames.tileError(job, 0, 2), row);
        EXPECT_FALSE(t.frames.tileError(job, 0, 1));
        ASSERT_EQ(t.frames.tileErrors(job, 0).size(), 2u);
        EXPECT_EQ(t.frames.tileErrors(job, 0)[0].tile, 0u);
        EXPECT_EQ(t.frames.tileErrors(job, 0)[1], row);
    });
    write([&](Tables& t) { t.frames.dropTileErrors(job, 0); });
    read([&](const ConstTables& t) { EXPECT_TRUE(t.frames.tileErrors(job, 0).empty()); });
}

TEST_P(JobStoreContract, SumsUpTheWorkOfFrames) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        EXPECT_EQ(t.frames.work(job + 1), FrameWork{});
        FrameRow frame = *t.frames.find(job, 0);
        frame.passes = 7;
        frame.pixelSamples = 700;
        frame.stopReason = StopReason::wallSeconds;
        frame.forecastAt = 1;
        frame.forecastSeconds = 10;
        frame.forecastLow = 9;
        frame.forecastHigh = 12;
        t.frames.update(frame);
        frame.frame = 1;
        frame.started = kNow;
        frame.passes = 1;
        t.frames.insert(frame);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.frames.work(job), (FrameWork{.passes = 8, .pixelSamples = 1400}));
        EXPECT_EQ(t.frames.find(job, 0)->stopReason, StopReason::wallSeconds);
        EXPECT_EQ(t.frames.find(job, 1)->forecastAt, 1);
        EXPECT_EQ(t.frames.find(job, 0)->forecastSeconds, 10);
        EXPECT_EQ(t.frames.find(job, 0)->forecastLow, 9);
        EXPECT_EQ(t.frames.find(job, 1)->forecastHigh, 12);
        EXPECT_EQ(t.frames.find(job, 1)->started, kNow);
    });
}

TEST_P(JobStoreContract, QueuesThePassesThatAreNamed) {
    const JobKey job = addFrame(3);
    write([&](Tables& t) {
        t.passes.drop(job, 0);
        t.passes.insert(job, 0, {{0, {8, 8}}, {2, {4, 4}}}, kNow);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.passes.lowestQueued(job, 0, 0), 4u);
        EXPECT_EQ(t.passes.find(job, 0, 0, 8)->samples, (SampleRange{8, 8}));
        EXPECT_FALSE(t.passes.find(job, 0, 1, 8));
    });
    EXPECT_EQ(counts(job), (PassCounts{.queued = 2}));
    EXPECT_EQ(codeOf([&] { write([&](Tables& t) {
                               t.passes.insert(job, 0, {{2, {4, 4}}}, kNow);
                           }); }),
              ErrorCode::conflict);
}

TEST_P(JobStoreContract, ListsFramesByJobAndState) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        FrameRow second = *t.frames.find(job, 0);
        second.frame = 1;
        t.frames.insert(second);
        second.state = FrameState::finishing;
        second.relativeError = 0.5;
        t.frames.update(second);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.frames.list(job).size(), 2u);
        ASSERT_EQ(t.frames.listActive(job).size(), 1u);
        EXPECT_EQ(t.frames.listActive(job)[0].frame, 0);
        EXPECT_EQ(t.frames.listByState(FrameState::finishing).at(0).relativeError, 0.5);
    });
}

TEST_P(JobStoreContract, KeepsLevelsBySamples) {
    const JobKey job = addFrame(1);
    ErrorTail tail;
    tail.add({3, 4, 0.1});
    const LevelRow two{.job = job,
                       .samples = 2,
                       .tiles = 1,
                       .relativeVariance = 0.5,
                       .errorSquares = 0.25,
                       .borrowedVariance = 0.125,
                       .errorTail = tail,
                       .droppedSamples = 3,
                       .relativeError = 0.1,
                       .deviceSeconds = 2.0};
    const LevelRow one{.job = job, .samples = 1, .tiles = 1, .relativeError = {}, .deviceSeconds = 1.0};
    write([&](Tables& t) {
        t.frames.put(LevelRow{.job = job, .samples = 2, .relativeError = {}, .deviceSeconds = {}});
        t.frames.put(two);
        t.frames.put(one);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.frames.levels(job, 0), (std::vector<LevelRow>{one, two}));
        EXPECT_EQ(t.frames.level(job, 0, 2), two);
        EXPECT_EQ(t.frames.level(job, 0, 4), std::nullopt);
    });
}

TEST_P(JobStoreContract, NeverGivesAnEpochTwice) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        EXPECT_EQ(t.leases.lastEpoch(), 0u);
        t.leases.insert({.epoch = 7,
                         .id = "l",
                         .worker = "w",
                         .job = job,
                         .granted = kNow,
                         .passes = {{3, {8, 16}}, {4, {8, 16}}}});
        t.leases.close(7, LeaseState::expired);
    });
    read([&](const ConstTables& t) {
        const LeaseRow lease = t.leases.find("l").value();
        EXPECT_EQ(lease.state, LeaseState::expired);
        EXPECT_EQ(lease.passes, (std::vector<LeasedPass>{{3, {8, 16}}, {4, {8, 16}}}));
        EXPECT_TRUE(t.leases.open().empty());
    });
    write([&](Tables& t) { t.leases.forgetClosedBefore(kNow + Milliseconds(1), 10); });
    read([&](const ConstTables& t) {
        EXPECT_FALSE(t.leases.find("l"));
        EXPECT_EQ(t.leases.lastEpoch(), 7u);
    });
}

TEST_P(JobStoreContract, RemembersLeasesThatWereLostWithTheirProcess) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        for (const uint64_t epoch : {1, 2, 3}) {
            t.leases.insert({.epoch = epoch,
                             .id = "l" + std::to_string(epoch),
                             .worker = "w",
                             .job = job,
                             .passes = {},
                             .session = "s",
                             .machine = "m"});
        }
        t.leases.setLoss(1, Loss::counted);
        t.leases.setLoss(2, Loss::shared);
        t.leases.setLoss(3, Loss::shared);
        t.leases.setLoss(3, Loss::none);
    });
    read([&](const ConstTables& t) {
        const auto lost = t.leases.lost();
        ASSERT_EQ(lost.size(), 2u);
        EXPECT_EQ(lost[0].loss, Loss::counted);
        EXPECT_EQ(lost[0].session, "s");
        EXPECT_EQ(lost[0].machine, "m");
        EXPECT_EQ(lost[1].loss, Loss::shared);
    });
}

TEST_P(JobStoreContract, CountsTheDeathsOfEachPassAndNeverBelowNone) {
    const JobKey job = addFrame(1), other = addFrame(1, "b");
    const auto held = [](JobKey key, std::vector<LeasedPass> passes) {
        return LeaseRow{.id = {}, .worker = {}, .job = key, .frame = -1, .passes = std::move(passes)};
    };
    write([&](Tables& t) {
        t.leases.addDeaths(held(job, {{7, {0, 1}}, {2, {1, 1}}}), 1);
        t.leases.addDeaths(held(job, {{2, {1, 1}}}), 1);
        t.leases.addDeaths(held(other, {{2, {1, 1}}}), 1);
        t.leases.addDeaths(held(other, {{3, {1, 1}}}), -1);
        t.leases.addDeaths(held(other, {{3, {1, 1}}}), 1);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.leases.deadly(job, 1), (DeadlyPass{-1, 7, 0, 1}));  // the first in the order of leases
        EXPECT_EQ(t.leases.deadly(job, 2), (DeadlyPass{-1, 2, 1, 2}));
        EXPECT_EQ(t.leases.deadly(job, 3), std::nullopt);
        EXPECT_EQ(t.leases.deadly(other, 2), std::nullopt);
    });
    write([&](Tables& t) {
        t.leases.addDeaths(held(job, {{2, {1, 1}}}), -1);
        EXPECT_EQ(t.leases.deadly(job, 2), std::nullopt);
        t.leases.forgetDeaths(job);
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.leases.deadly(job, 1), std::nullopt);
        EXPECT_TRUE(t.leases.deadly(other, 1));
    });
}

TEST_P(JobStoreContract, FindsPassesWhoseLeaseIsNotOpen) {
    const JobKey job = addFrame(2);
    write([&](Tables& t) {
        t.leases.insert({.epoch = 1, .id = "l", .worker = "w", .job = job, .passes = {}});
    });
    claim(job, 1, 1);
    claim(job, 2, 1);
    read([&](const ConstTables& t) {
        const auto lost = t.passes.leasedWithoutLease(10);
        ASSERT_EQ(lost.size(), 1u);
        EXPECT_EQ(lost[0].tile, 1u);
    });
}

TEST_P(JobStoreContract, CountsFailuresPerWorkerAndBlamesAWorkerOnlyWhereOthersSucceed) {
    const JobKey job = addFrame(1), other = addFrame(1, "b");
    write([&](Tables& t) {
        for (int i = 0; i < 2; ++i) t.leases.addFailure({job, 0, 0, 0, "w", "message", 1});
        t.leases.addFailure({job, 0, 0, 0, "v", "message", 1});
        t.leases.addFailure({other, 0, 0, 0, "w", "message", 1});
        t.workers.addContribution({job, "v", 1.0, 1, 100});
        t.workers.addContribution({other, "w", 1.0, 1, 100});
    });
    read([&](const ConstTables& t) {
        const auto failures = t.leases.failures(job, 0, 0, 0);
        ASSERT_EQ(failures.size(), 2u);
        EXPECT_EQ(failures[0].reports + failures[1].reports, 3u);
        EXPECT_EQ(t.leases.jobsOnlyThisWorkerFailed("w"), 1u);
        EXPECT_EQ(t.leases.jobsOnlyThisWorkerFailed("v"), 0u);
    });
}

TEST_P(JobStoreContract, AddsUpContributionsAndKeepsTheLastReport) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        t.workers.addContribution({job, "w", 1.5, 2, 100});
        t.workers.addContribution({job, "w", 0.5, 1, 50});
        t.workers.putReport({job, "w", "{}"});
        t.workers.putReport({job, "w", R"({"a":1})"});
    });
    read([&](const ConstTables& t) {
        const auto rows = t.workers.contributions(job);
        ASSERT_EQ(rows.size(), 1u);
        EXPECT_EQ(rows[0].deviceSeconds, 2.0);
        EXPECT_EQ(rows[0].passes, 3u);
        EXPECT_EQ(rows[0].samples, 150u);
        EXPECT_EQ(t.workers.reports(job).at(0).json, R"({"a":1})");
    });
}

TEST_P(JobStoreContract, KeepsWorkersUntilForgotten) {
    const WorkerHello hello{"w", "host", "device", "driver", "1"};
    write([&](Tables& t) {
        t.workers.put({hello, WorkerState::online, "", kNow, kNow});
        t.workers.put({hello, WorkerState::quarantined, "why", kNow, kNow});
    });
    read([&](const ConstTables& t) {
        ASSERT_EQ(t.workers.list().size(), 1u);
        EXPECT_EQ(t.workers.list()[0].hello, hello);
        EXPECT_EQ(t.workers.list()[0].state, WorkerState::quarantined);
        EXPECT_EQ(t.workers.list()[0].reason, "why");
    });
    write([&](Tables& t) { t.workers.forgetSeenBefore(kNow + Milliseconds(1)); });
    read([&](const ConstTables& t) { EXPECT_TRUE(t.workers.list().empty()); });
}

TEST_P(JobStoreContract, GivesEventsInOrderAndNeverAnIdTwice) {
    const JobKey job = addFrame(1);
    write([&](Tables& t) {
        t.events.add({0, job, "a", kNow, "job", "{}"});
        t.events.add({0, 0, "", kNow, "worker", "{}"});
        t.events.add({0, job, "a", kNow, "progress", "{}"});
    });
    read([&](const ConstTables& t) {
        EXPECT_EQ(t.events.list(0, std::nullopt, 10).size(), 3u);
        EXPECT_EQ(t.events.list(0, std::nullopt, 2).size(), 2u);
        const auto ofJob = t.events.list(1, job, 10);
        ASSERT_EQ(ofJob.size(), 1u);
        EXPECT_EQ(ofJob[0].type, "progress");
    });
    write([&](Tables& t) {
        t.events.forgetBelow(100, 1000);
        EXPECT_EQ(t.events.add({0, job, "a", kNow, "job", "{}"}), 4);
        EXPECT_EQ(t.events.lastId(), 4);
    });
}

INSTANTIATE_TEST_SUITE_P(Memory, JobStoreContract, testing::Values([](const TemporaryFolder&) {
                             return std::make_unique<MemoryJobStore>();
                         }),
                         backendName("Memory"));
INSTANTIATE_TEST_SUITE_P(Sqlite, JobStoreContract, testing::Values([](const TemporaryFolder& folder) {
                             return std::make_unique<SqliteJobStore>(folder / "tilefarm.sqlite");
                         }),
                         backendName("Sqlite"));

}  // namespace
}  // namespace tilefarm
