#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "server/queue/job_catalog.h"
#include "server/queue/worker_roster.h"
#include "server/store/job_store.h"
#include "shared/film/film.h"
#include "shared/job/lease.h"

namespace tilefarm {

struct QueueConfig {
    Milliseconds leaseTime{30000};
    Milliseconds idleRetry{500};             // what an idle worker waits before it asks again
    Milliseconds workerOnlineFor{60000};     // after its last call
    uint64_t firstLeaseSamples = 262144;     // pixel samples for a worker of unknown speed
    uint64_t mostPixelsPerLease = 1u << 20;  // pixels times passes; 64 bytes each in the upload
    size_t failingWorkers = 3;               // distinct ones that make a pass fail
    size_t quarantineJobs = 3;               // a worker alone in failing on so many is quarantined
    size_t deathsThatSetAside = 3;           // of workers that held the same pass; 0: however many
    int64_t eventsKept = 200000;
};

/// No work now, or none for this worker at all (`reason` says why).
struct NoLease {
    Milliseconds retryAfter{};
    std::string reason;
};

struct Submission {
    JobRow job;
    bool created = false;  // false: the same request came before
};

/// A lease that was granted at some time, with what its result needs.
struct ResultTarget {
    LeaseRow lease;
    std::shared_ptr<const JobInfo> job;
};

/// One tile's share of a result, as server/film merged it and made it durable.
struct TileMerge {
    TileRow before, after;         // rows of the tile; the film slot of `after` is on disk
    std::vector<uint32_t> merged;  // first samples of passes of this upload now in the film
    std::vector<uint32_t> unheld;  // of earlier uploads, held until now and now in the film
    std::vector<PassRow> held;     // of this upload, kept in a file until their turn
    std::vector<LevelRow> levels;  // what this tile adds to each level it reached
};

struct ResultMerge {
    std::vector<TileMerge> tiles;
    double deviceSeconds = 0;      // the worker's statement for the whole upload
    uint64_t uploadedSamples = 0;  // pixel samples of the whole upload
    uint32_t alreadyMerged = 0;
    PassFaults faults{};       // of the passes that are newly merged or held
    double keptLuminance = 0;  // of their samples, summed up, where the job clamps
};

/// A broken invariant that a sweep found, and what was done about it.
struct Violation {
    std::string invariant;
    std::string detail;
    bool repaired = false;
};

/// Decides who works on what, and is the only mover of states. Any thread may call; every change is
/// one transaction and durable when the call returns.
/// Throws Error: notFound for unknown ids, conflict where shared/job/states.h has no such move.
class Scheduler {
public:
    /// `changed` is called after every transaction that wrote events, from the calling thread.
    Scheduler(JobStore& store, const Clock& clock, QueueConfig config = {},
              std::function<void()> changed = {});

    // Jobs
    /// A repeated key gives the first job; with another body it throws Error(conflict).
    Submission submit(const JobSpec& spec, const std::string& idempotencyKey = {},
                      const std::string& bodyDigest = {});
    JobRow cancel(const std::string& id);
    JobRow pause(const std::string& id);
    JobRow resume(const std::string& id);

    // Leases
    /// Gives the highest priority, oldest job's next passes, breadth-first over sample levels: as many
    /// as the worker renders in `wantSeconds` by its measured speed. The worker must renew within
    /// QueueConfig::leaseTime; a worker that dies needs no clean-up, its lease runs out.
    std::variant<Lease, NoLease> lease(const WorkerHello& hello, double wantSeconds);
    /// Throws Error(gone) when the job is canceled, Error(conflict) when the lease was lost.
    void renew(const std::string& leaseId, uint64_t epoch);
    void handBack(const std::string& leaseId, uint64_t epoch);
    /// A render error, as opposed to a timeout, counts: see QueueConfig::failingWorkers. With fewer
    /// workers online than that, three reports by all of them are enough.
    void reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message);
    void putReport(const std::string& leaseId, uint64_t epoch, const std::string& json);
    /// Takes back leases that were not renewed in time. A restarted server waits one lease first. Until
    /// the worker's process is heard from again that counts as its death: see
    /// QueueConfig::deathsThatSetAside.
    void expire();

    // Results
    /// What an upload belongs to. Throws Error(notFound | gone | conflict).
    ResultTarget resultTarget(const std::string& leaseId, uint64_t epoch);
    /// Counts a result exactly once: flips the film slots, marks the passes, adds the seconds.
    ResultReceipt commit(const ResultTarget& target, const ResultMerge& merge);
    /// The frame's final image is durable. Completes the job with its last frame.
    void frameWritten(JobKey job, int32_t frame, const std::string& exrSha256, uint64_t exrBytes);

    /// Checks the named invariants and repairs what it can; at start and every minute. Others go on
    /// meanwhile: rows are compared in readers' views, and changed few at a time.
    std::vector<Violation> sweep();

    std::vector<WorkerRow> workers() const;
    double workerRate(const std::string& worker) const;
    size_t openLeases() const;
    Milliseconds leaseTime() const { return config_.leaseTime; }
    JobCatalog& catalog() { return catalog_; }

private:
    struct OpenLease {
        uint64_t epoch = 0;
        JobKey job = 0;
        std::string worker;
        TimePoint deadline{};
        std::string session;
        bool alone = false;          // a trial of a suspect frame: its process holds nothing else
        uint64_t frameRevision = 0;  // when it was granted
    };
    struct LostLease {
        JobKey job = 0;
        std::string session;
    };
    enum class Turn { now, later, wait };
    struct Budget {
        double samples = 0;
        uint64_t pixels = 0;
        uint64_t passes = 0;
    };

    void write(const std::function<void(Tables&)>& work);
    void note(Tables& t, const JobRow& job, std::string type, std::string json);
    void noteJobState(Tables& t, const JobRow& job);
    JobRow moveJob(const std::string& id, const std::function<JobState(const JobRow&)>& target);
    void endJob(Tables& t, JobRow& job, JobState state);

    std::optional<Lease> leaseFrom(Tables& t, JobRow job, const WorkerHello& hello, double wantSeconds);
    Budget budgetFor(const JobRow& job, const JobInfo& info, const std::vector<FrameRow>& frames,
                     const std::string& worker, double wantSeconds);
    FrameRow startFrame(Tables& t, JobRow& job, const JobInfo& info);
    std::vector<LeasedPass> takePasses(Tables& t, FrameRow& frame, const JobInfo& info,
                                       const std::string& worker, uint64_t epoch, Budget budget);
    Lease grant(Tables& t, JobRow& job, const JobInfo& info, const FrameRow& frame, const WorkerHello& hello,
                uint64_t epoch, std::vector<LeasedPass> passes);

    OpenLease& openLease(const std::string& leaseId, uint64_t epoch);
    [[noreturn]] void explainLost(const std::string& leaseId, uint64_t epoch);
    uint64_t giveUp(Tables& t, const std::string& leaseId, LeaseState state);
    bool failPass(Tables& t, PassRow& pass, const std::string& worker, const std::string& message);
    void failLeasedPasses(Tables& t, const LeaseRow& lease, const std::string& message);
    void quarantineIfAlone(Tables& t, const std::string& worker);
    void closeLeasesOf(Tables& t, JobKey job);

    Turn turnOf(const JobRow& job, const WorkerHello& hello) const;
    bool inTrial(const std::string& session) const;
    void loseLeases(const std::function<bool(const OpenLease&)>& lost);
    Loss lose(Tables& t, const std::string& leaseId);
    bool heldOneJobOnly(const std::string& session) const;
    void bury(const std::vector<std::string>& sessions);
    void heard(const std::string& session);
    void heardOfLease(const std::string& leaseId);
    void takeBackDeath(Tables& t, const std::string& leaseId);
    std::optional<DeadlyPass> deadlyPassOf(Tables& t, const JobRow& job) const;
    void setAsideIfDeadly(Tables& t, JobRow& job);
    void forgive(Tables& t, JobRow& job);

    struct Tally;
    void commitTile(Tables& t, FrameRow& frame, const TileMerge& tile, Tally& tally);
    void commitPass(Tables& t, FrameRow& frame, PassRow pass, Tally& tally);
    void completeLevels(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info,
                        const ResultMerge& merge, double secondsBefore);
    void completeLevel(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info, LevelRow& level);
    void dropTail(Tables& t, const FrameRow& frame);

    std::vector<JobKey> jobKeys(const JobQuery& query) const;
    void freeUnleasedPasses(std::vector<Violation>& found);
    void sweepJob(JobKey key, std::vector<Violation>& found);
    void closeUnwatchedLeases(std::vector<Violation>& found);
    void forgetOldRows();

    void measureTile(Tables& t, const FrameRow& frame, const TileMerge& tile);
    static bool atFixedPoint(const FrameRow& frame, const JobInfo& info);
    static void keepForecast(const Tables& t, FrameRow& frame, const JobInfo& info);
    void decideNext(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info);
    static uint64_t passesBeforeFixedPoints(const JobInfo& info, const std::vector<FrameRow>& frames);
    static FrameWork workOfNext(const Tables& t, const JobRow& job, const JobInfo& info);
    void expectWork(Tables& t, JobRow& job, FrameRow& frame, const SampleDecision& next);
    void promote(Tables& t, FrameRow& frame, const JobInfo& info, std::vector<TileErrorRow>& rows,
                 const std::vector<uint32_t>& tiles);
    void finishFrame(Tables& t, const JobRow& job, FrameRow& frame, StopReason reason);

    JobStore& store_;
    const Clock& clock_;
    QueueConfig config_;
    std::function<void()> changed_;
    JobCatalog catalog_;

    mutable std::mutex mutex_;  // every change goes through it; guards what follows
    WorkerRoster roster_;
    std::map<std::string, OpenLease> open_;  // by lease id; deadlines are not worth a write each
    std::map<std::string, LostLease> lost_;  // by lease id; the process has not been heard from since
    bool eventsWritten_ = false;
};

}  // namespace tilefarm
