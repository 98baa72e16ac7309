#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/store/rows.h"

namespace tilefarm {

/// The tables of the queue, one small interface per concept. They keep rows and guard the moves of
/// states (Error(conflict) on a move that shared/job/states.h lacks); what moves when is decided in
/// server/queue alone. Methods that write may be called inside JobStore::write only.

struct JobQuery {
    std::optional<JobState> state;
    JobKey before = INT64_MAX;  // newest first, keys below this
    size_t limit = 50;
};

/// Of the jobs in one state.
struct JobTotals {
    uint64_t jobs = 0, passes = 0, passesMerged = 0, passesQueued = 0, passesLeased = 0;
    friend bool operator==(const JobTotals&, const JobTotals&) = default;
};

struct JobTable {
    virtual ~JobTable() = default;
    virtual std::optional<JobRow> find(const std::string& id) const = 0;
    virtual std::optional<JobRow> find(JobKey key) const = 0;
    virtual std::optional<JobRow> findByIdempotencyKey(const std::string& key) const = 0;
    virtual std::vector<JobRow> list(const JobQuery& query) const = 0;
    /// What was submitted, whole: up to megabytes.
    virtual std::string spec(JobKey key) const = 0;
    /// Jobs that hand out work (queued or running, with passes neither merged nor on loan), highest priority
    /// first, then oldest; `visit` returns false to stop.
    virtual void forEachLeasable(const std::function<bool(JobKey)>& visit) const = 0;
    /// Kept with every write, not counted: states without jobs may be left out.
    virtual std::map<JobState, JobTotals> totals() const = 0;
    /// When the oldest job that waits was made.
    virtual std::optional<TimePoint> oldestQueued() const = 0;
    virtual JobKey insert(const JobRow& row, const std::string& spec) = 0;
    virtual void update(const JobRow& row) = 0;
};

struct FrameTable {
    virtual ~FrameTable() = default;
    virtual std::optional<FrameRow> find(JobKey job, int32_t frame) const = 0;
    virtual std::vector<FrameRow> list(JobKey job) const = 0;
    virtual std::vector<FrameRow> listByState(FrameState state) const = 0;
    /// Frames of a job that have, or may still get, passes to hand out.
    virtual std::vector<FrameRow> listActive(JobKey job) const = 0;
    /// Those among them that have some now: the others are wholly on loan or merged. By number.
    virtual std::vector<FrameRow> listWithWork(JobKey job) const = 0;
    virtual size_t countActive(JobKey job) const = 0;
    /// Makes the frame with its tiles, none of which has samples.
    virtual void insert(const FrameRow& row) = 0;
    virtual void update(const FrameRow& row) = 0;
    virtual std::optional<TileRow> tile(JobKey job, int32_t frame, uint32_t tile) const = 0;
    virtual std::vector<TileRow> tiles(JobKey job, int32_t frame) const = 0;
    virtual void update(const TileRow& row) = 0;
    virtual void dropTiles(JobKey job, int32_t frame) = 0;
    virtual std::optional<TileErrorRow> tileError(JobKey job, int32_t frame, uint32_t tile) const = 0;
    /// By tile.
    virtual std::vector<TileErrorRow> tileErrors(JobKey job, int32_t frame) const = 0;
    virtual void put(const TileErrorRow& row) = 0;
    virtual void dropTileErrors(JobKey job, int32_t frame) = 0;
    /// Of all frames of the job that have rows.
    virtual FrameWork work(JobKey job) const = 0;
    virtual std::optional<LevelRow> level(JobKey job, int32_t frame, uint32_t samples) const = 0;
    /// By samples.
    virtual std::vector<LevelRow> levels(JobKey job, int32_t frame) const = 0;
    virtual void put(const LevelRow& row) = 0;
};

struct PassClaim {
    JobKey job = 0;
    int32_t frame = 0;
    uint64_t epoch = 0;
    SampleRange level;  // only passes of this range
    size_t limit = 1;
    std::string worker;        // passes that this worker failed are left out, unless
    size_t onlineWorkers = 1;  // so many distinct workers failed them
};

struct PassCounts {
    uint64_t queued = 0, leased = 0, merged = 0, failed = 0;
    friend bool operator==(const PassCounts&, const PassCounts&) = default;
};

/// Passes with rows: those of created levels that not every tile of the frame has merged.
/// A (tile, first sample) of a frame has one row at most.
struct PassTable {
    virtual ~PassTable() = default;
    virtual std::optional<PassRow> find(JobKey job, int32_t frame, uint32_t tile, uint32_t first) const = 0;
    /// First sample of the lowest level that has a queued pass.
    virtual std::optional<uint32_t> lowestQueued(JobKey job, int32_t frame, uint32_t from) const = 0;
    virtual PassCounts counts(JobKey job, int32_t frame) const = 0;
    /// Leased passes whose lease is not open, and early passes that wait.
    virtual std::vector<PassRow> leasedWithoutLease(size_t limit) const = 0;
    virtual std::vector<PassRow> held() const = 0;
    virtual std::vector<PassRow> heldOf(JobKey job, int32_t frame, uint32_t tile) const = 0;
    /// Whether an early pass still waits in the file.
    virtual bool isHeld(const std::string& file) const = 0;
    virtual std::optional<TimePoint> oldestQueued() const = 0;
    /// One queued pass of `level` for each of the tiles [0, tiles).
    virtual void insertLevel(JobKey job, int32_t frame, SampleRange level, uint32_t tiles, TimePoint now) = 0;
    /// Likewise one for each that is named.
    virtual void insert(JobKey job, int32_t frame, const std::vector<LeasedPass>& passes, TimePoint now) = 0;
    /// Moves up to `limit` queued passes to leased in one statement; gives them by tile.
    virtual std::vector<LeasedPass> claim(const PassClaim& claim) = 0;
    virtual void update(const PassRow& row) = 0;
    /// Leased passes of a lease go back to queued; how many.
    virtual uint64_t release(uint64_t epoch, TimePoint now) = 0;
    /// Forgets rows below a sample (merged everywhere), or all of the frame.
    virtual void drop(JobKey job, int32_t frame, uint32_t belowFirst = UINT32_MAX) = 0;
};

struct LeaseTable {
    virtual ~LeaseTable() = default;
    virtual std::optional<LeaseRow> find(const std::string& id) const = 0;
    virtual std::vector<LeaseRow> open() const = 0;
    /// Highest epoch there ever was, forgotten leases included.
    virtual uint64_t lastEpoch() const = 0;
    virtual void insert(const LeaseRow& row) = 0;
    virtual void close(uint64_t epoch, LeaseState state) = 0;
    /// The oldest ones first, up to `limit`; how many.
    virtual uint64_t forgetClosedBefore(TimePoint granted, size_t limit) = 0;
    /// Failures: distinct (pass, worker), with the number of reports.
    virtual void addFailure(const FailureRow& row) = 0;
    virtual std::vector<FailureRow> failures(JobKey job, int32_t frame, uint32_t tile,
                                             uint32_t first) const = 0;
    /// Leases that were lost with their process, and not found again.
    virtual std::vector<LeaseRow> lost() const = 0;
    virtual void setLoss(uint64_t epoch, Loss loss) = 0;
    /// Adds to the deaths of each pass of the lease; never below none.
    virtual void addDeaths(const LeaseRow& lease, int32_t count) = 0;
    /// The first pass with at least so many deaths.
    virtual std::optional<DeadlyPass> deadly(JobKey job, uint64_t least) const = 0;
    virtual void forgetDeaths(JobKey job) = 0;
    /// Jobs in which the worker failed and another worker had passes merged.
    virtual size_t jobsOnlyThisWorkerFailed(const std::string& worker) const = 0;
};

struct WorkerTable {
    virtual ~WorkerTable() = default;
    virtual std::vector<WorkerRow> list() const = 0;
    virtual void put(const WorkerRow& row) = 0;
    virtual void forgetSeenBefore(TimePoint lastSeen) = 0;
    virtual std::vector<ContributionRow> contributions(JobKey job) const = 0;
    /// Adds to what the worker gave to the job before.
    virtual void addContribution(const ContributionRow& row) = 0;
    virtual std::vector<ReportRow> reports(JobKey job) const = 0;
    virtual void putReport(const ReportRow& row) = 0;
};

struct EventTable {
    virtual ~EventTable() = default;
    /// Oldest first, ids above `after`; of one job, or of all.
    virtual std::vector<EventRow> list(int64_t after, std::optional<JobKey> job, size_t limit) const = 0;
    virtual int64_t lastId() const = 0;
    virtual int64_t add(const EventRow& row) = 0;
    /// The oldest ones first, up to `limit`; how many.
    virtual uint64_t forgetBelow(int64_t id, size_t limit) = 0;
};

struct StudyTable {
    virtual ~StudyTable() = default;
    virtual std::optional<StudyRow> find(const std::string& id) const = 0;
    /// Newest first, keys below `before`.
    virtual std::vector<StudyRow> list(int64_t before, size_t limit) const = 0;
    /// Those that are not finished, oldest first.
    virtual std::vector<StudyRow> open() const = 0;
    virtual int64_t insert(const StudyRow& row) = 0;
    virtual void update(const StudyRow& row) = 0;
    /// What was measured, without its pictures, by number.
    virtual std::vector<StudyCellRow> cells(int64_t study) const = 0;
    virtual std::optional<StudyCellRow> cell(int64_t study, uint32_t cell) const = 0;
    virtual void putCell(const StudyCellRow& row) = 0;
};

struct Tables {
    JobTable& jobs;
    FrameTable& frames;
    PassTable& passes;
    LeaseTable& leases;
    WorkerTable& workers;
    EventTable& events;
    StudyTable& studies;
};

struct ConstTables {
    const JobTable& jobs;
    const FrameTable& frames;
    const PassTable& passes;
    const LeaseTable& leases;
    const WorkerTable& workers;
    const EventTable& events;
    const StudyTable& studies;
    ConstTables(const Tables& t)  // NOLINT: a writer may read
        : jobs(t.jobs),
          frames(t.frames),
          passes(t.passes),
          leases(t.leases),
          workers(t.workers),
          events(t.events),
          studies(t.studies) {}
};

/// Keeps the queue's rows. Any thread may call; writers run one at a time.
struct JobStore {
    virtual ~JobStore() = default;
    /// One transaction: durable when this returns, undone whole when `work` throws.
    virtual void write(const std::function<void(Tables&)>& work) = 0;
    /// A consistent view; does not wait for a writer.
    virtual void read(const std::function<void(const ConstTables&)>& work) const = 0;
};

}  // namespace tilefarm
