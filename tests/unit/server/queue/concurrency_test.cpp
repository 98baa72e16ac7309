// The queue with everybody at once: workers that deliver, deliver twice, in part, late or never, that hand
// back and report failures; a person who pauses, resumes and cancels; readers; a clock that lets leases run
// out, and the sweep. Over every store. Afterwards each pass was counted once and the films have the bits of
// a render in one go. Run it under the thread sanitizer as well: deploy/test.sh tsan.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <set>
#include <thread>

#include "shared/error/error.h"
#include "tests/support/memory_job_store.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

constexpr uint64_t kPassesPerFrame = 6 * 4;  // tiles and ranges of smallJob()
constexpr uint32_t kFrames = 2;
constexpr int kWorkers = 6;

struct SharedClock : Clock {
    std::atomic<int64_t> milliseconds{1'700'000'000'000};
    TimePoint now() const override { return TimePoint(Milliseconds(milliseconds.load())); }
    void advance(Milliseconds by) { milliseconds += by.count(); }
};

JobSpec jobOf(const std::string& name) {
    JobSpec spec = smallJob();
    spec.frames = {0, kFrames};
    spec.name = name;
    return spec;
}

QueueConfig smallLeases() {
    QueueConfig config;
    config.mostPixelsPerLease = 6 * 16 * 16;
    config.quarantineJobs = 1000;
    return config;
}

// What a call that comes too late, or after a cancellation, is told.
bool isAnswer(ErrorCode code) {
    return code == ErrorCode::gone || code == ErrorCode::conflict || code == ErrorCode::notFound;
}

struct Backend {
    const char* name;
    std::unique_ptr<JobStore> (*make)(const TemporaryFolder&);
    friend void PrintTo(const Backend& backend, std::ostream* out) { *out << backend.name; }
};

class ConcurrentQueue : public testing::TestWithParam<Backend> {
protected:
    void SetUp() override {
        for (const char* name : {"kept", "paused", "canceled"}) {
            ids.push_back(scheduler.submit(jobOf(name)).job.id);
            merged[ids.back()] = 0;
        }
    }

    void act(const Lease& lease, std::mt19937& random, const std::string& worker) {
        const auto passes = renderLease(lease);
        switch (random() % 10) {
            case 0: return;  // forgotten: it runs out
            case 1: return scheduler.handBack(lease.id, lease.epoch);
            case 2: scheduler.renew(lease.id, lease.epoch); break;
            case 3:
                // One worker's failures alone never make a pass fail.
                if (worker == "w0") return scheduler.reportFailure(lease.id, lease.epoch, "broken");
                break;
            case 4: deliver(lease, {passes.begin(), passes.begin() + 1}); break;
            case 5: deliver(lease, passes); break;  // and once more
            case 6: scheduler.putReport(lease.id, lease.epoch, "{}"); break;
            default: break;
        }
        deliver(lease, passes);
    }

    void deliver(const Lease& lease, const std::vector<PassFilm>& passes) {
        merged.at(lease.jobId) +=
            merger.accept(scheduler.resultTarget(lease.id, lease.epoch), passes, 1).merged;
    }

    void work(int number) {
        const std::string worker = "w" + std::to_string(number);
        std::mt19937 random(static_cast<uint32_t>(number));
        while (!done) {
            try {
                auto answer = scheduler.lease(hello(worker), 5);
                if (const auto* lease = std::get_if<Lease>(&answer))
                    act(*lease, random, worker);
                else
                    std::this_thread::yield();
            } catch (const Error& error) {
                EXPECT_TRUE(isAnswer(error.code)) << error.what();
            }
        }
    }

    void people() {
        bool canceled = false;
        while (!done) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            try {
                scheduler.pause(ids[1]);
                scheduler.resume(ids[1]);
                if (!canceled && merged.at(ids[2]) > kPassesPerFrame / 2) {
                    scheduler.cancel(ids[2]);
                    canceled = true;
                }
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::conflict) << error.what();
            }
        }
    }

    // Whatever is under way, a reader sees rows that fit each other.
    void look() {
        while (!done) {
            store->read([&](const ConstTables& t) {
                for (const std::string& id : ids) {
                    const JobRow job = t.jobs.find(id).value();
                    for (const FrameRow& frame : t.frames.list(job.key))
                        EXPECT_EQ(t.passes.counts(job.key, frame.frame).leased, frame.passesLeased);
                }
            });
            scheduler.workers();
            scheduler.openLeases();
        }
    }

    bool allMerged(const std::string& id) const { return merged.at(id) >= kPassesPerFrame * kFrames; }

    // Lets leases run out, and time pass.
    void keepTime() {
        const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(120);
        while (!(allMerged(ids[0]) && allMerged(ids[1]) && job(ids[2]).state == JobState::canceled) &&
               std::chrono::steady_clock::now() < limit) {
            // Slower than workers render: where every lease runs out, nothing is merged.
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
            clock.advance(Milliseconds(2000));
            scheduler.expire();
            for (const Violation& violation : scheduler.sweep())
                ADD_FAILURE() << violation.invariant << ": " << violation.detail;
        }
        done = true;
    }

    JobRow job(const std::string& id) const {
        JobRow row;
        store->read([&](const ConstTables& t) { row = t.jobs.find(id).value(); });
        return row;
    }

    void expectFilms(const std::string& id) {
        const JobRow row = job(id);
        for (int32_t frame = 0; frame < int32_t{kFrames}; ++frame) {
            std::vector<FilmTile> tiles;
            std::vector<TileRow> rows;
            std::shared_ptr<const JobInfo> info;
            store->read([&](const ConstTables& t) {
                info = scheduler.catalog().get(t, row);
                EXPECT_EQ(t.frames.find(row.key, frame)->state, FrameState::finishing);
                rows = t.frames.tiles(row.key, frame);
            });
            for (const TileRow& tile : rows) tiles.push_back(films.read(*info, frame, tile));
            EXPECT_TRUE(sameBits(tiles, renderFrame(info->spec, frame))) << id << " frame " << frame;
        }
    }

    TemporaryFolder folder;
    SharedClock clock;
    std::unique_ptr<JobStore> store = GetParam().make(folder);
    Scheduler scheduler{*store, clock, smallLeases()};
    MemoryBlobStore blobs;
    FilmStore films{folder.path()};
    FrameImages images{*store, scheduler, films, blobs, clock, folder.path()};
    ResultMerger merger{*store, scheduler, films};
    std::vector<std::string> ids;
    std::map<std::string, std::atomic<uint64_t>> merged;  // by job: what the receipts say
    std::atomic<int> created{0};
    std::atomic<bool> done{false};
};

TEST_P(ConcurrentQueue, CountsEachPassOnceAndLosesNone) {
    std::vector<std::thread> threads;
    for (int i = 0; i < kWorkers; ++i) threads.emplace_back([this, i] { work(i); });
    threads.emplace_back([this] { people(); });
    threads.emplace_back([this] { look(); });
    keepTime();
    for (std::thread& thread : threads) thread.join();

    for (const std::string& id : ids) EXPECT_EQ(job(id).passesMerged, merged.at(id)) << id;
    for (const std::string& id : {ids[0], ids[1]}) {
        EXPECT_EQ(merged.at(id), kPassesPerFrame * kFrames);
        expectFilms(id);
    }
    EXPECT_EQ(job(ids[2]).state, JobState::canceled);

    clock.advance(Milliseconds(60'000));
    scheduler.expire();
    EXPECT_EQ(scheduler.openLeases(), 0u);
    EXPECT_TRUE(scheduler.sweep().empty());
    store->read([&](const ConstTables& t) {
        int64_t last = 0;
        for (const EventRow& event : t.events.list(0, std::nullopt, 1'000'000)) {
            EXPECT_GT(event.id, last);
            last = event.id;
        }
        EXPECT_EQ(last, t.events.lastId());
    });
    EXPECT_TRUE(images.finishFrames().empty());
    for (const std::string& id : {ids[0], ids[1]}) EXPECT_EQ(job(id).state, JobState::completed);
}

TEST_P(ConcurrentQueue, MakesAJobOnceForManyRequestsOfAKey) {
    std::vector<std::thread> threads;
    std::set<std::string> made;
    std::mutex guard;
    for (int i = 0; i < kWorkers; ++i)
        threads.emplace_back([&] {
            for (int k = 0; k < 20; ++k) {
                const Submission submission =
                    scheduler.submit(jobOf("once"), "key " + std::to_string(k), "digest");
                created += submission.created;
                const std::lock_guard lock(guard);
                made.insert(submission.job.id);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(created, 20);
    EXPECT_EQ(made.size(), 20u);
}

INSTANTIATE_TEST_SUITE_P(
    Stores, ConcurrentQueue,
    testing::Values(Backend{"Memory",
                            [](const TemporaryFolder&) -> std::unique_ptr<JobStore> {
                                return std::make_unique<MemoryJobStore>();
                            }},
                    Backend{"Sqlite", [](const TemporaryFolder& folder) -> std::unique_ptr<JobStore> {
                                return std::make_unique<SqliteJobStore>(folder / "t.sqlite");
                            }}));

}  // namespace
}  // namespace tilefarm
