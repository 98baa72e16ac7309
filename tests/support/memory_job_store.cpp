// Long because it has all tables of a store, each in as few lines as do.
#include "tests/support/memory_job_store.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

using FrameKey = std::pair<JobKey, int32_t>;
using TileKey = std::tuple<JobKey, int32_t, uint32_t>;
using PassKey = std::tuple<JobKey, int32_t, uint32_t, uint32_t>;  // job, frame, first sample, tile

template <typename Rows>
void dropOfFrame(Rows& rows, JobKey job, int32_t frame) {
    std::erase_if(rows, [&](const auto& at) { return at.second.job == job && at.second.frame == frame; });
}

[[noreturn]] void refuse(const std::string& what) {
    throw Error(ErrorCode::conflict, what);
}

template <typename State>
void checkMove(State from, State to) {
    if (from != to && !canMove(from, to)) {
        refuse("no move from " + std::string(toString(from)) + " to " + std::string(toString(to)));
    }
}

struct Jobs : JobTable {
    std::map<JobKey, JobRow> rows;
    std::map<JobKey, std::string> specs;
    JobKey last = 0;
    const std::map<FrameKey, FrameRow>* frames = nullptr;  // of the frame table, set by State

    // The row with the sums over its frames, which are counted here whenever they are asked for.
    JobRow counted(JobRow row) const {
        row.passesQueued = row.passesLeased = 0;
        for (auto at = frames->lower_bound({row.key, INT32_MIN});
             at != frames->end() && at->first.first == row.key; ++at) {
            row.passesQueued += at->second.passesQueued;
            row.passesLeased += at->second.passesLeased;
        }
        return row;
    }
    std::optional<JobRow> findIf(const std::function<bool(const JobRow&)>& matches) const {
        for (const auto& [key, row] : rows) {
            if (matches(row)) return counted(row);
        }
        return std::nullopt;
    }
    std::optional<JobRow> find(const std::string& id) const override {
        return findIf([&](const JobRow& row) { return row.id == id; });
    }
    std::optional<JobRow> find(JobKey key) const override {
        const auto at = rows.find(key);
        return at == rows.end() ? std::nullopt : std::optional(counted(at->second));
    }
    std::optional<JobRow> findByIdempotencyKey(const std::string& key) const override {
        return findIf([&](const JobRow& row) { return !key.empty() && row.idempotencyKey == key; });
    }
    std::vector<JobRow> list(const JobQuery& query) const override {
        std::vector<JobRow> found;
        for (auto at = rows.rbegin(); at != rows.rend() && found.size() < query.limit; ++at) {
            if (at->first < query.before && (!query.state || at->second.state == *query.state)) {
                found.push_back(counted(at->second));
            }
        }
        return found;
    }
    std::string spec(JobKey key) const override { return specs.at(key); }
    void forEachLeasable(const std::function<bool(JobKey)>& visit) const override {
        std::vector<std::pair<int32_t, JobKey>> order;
        for (const auto& [key, row] : rows) {
            const bool handsOut = row.state == JobState::queued || row.state == JobState::running;
            if (handsOut && row.passesMerged + counted(row).passesLeased < row.passes)
                order.emplace_back(-row.priority, key);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [priority, key] : order) {
            if (!visit(key)) return;
        }
    }
    std::map<JobState, JobTotals> totals() const override {
        std::map<JobState, JobTotals> totals;
        for (const auto& [key, plain] : rows) {
            const JobRow row = counted(plain);
            JobTotals& of = totals[row.state];
            ++of.jobs;
            of.passes += row.passes;
            of.passesMerged += row.passesMerged;
            of.passesQueued += row.passesQueued;
            of.passesLeased += row.passesLeased;
        }
        return totals;
    }
    std::optional<TimePoint> oldestQueued() const override {
        const auto oldest = findIf([](const JobRow& row) { return row.state == JobState::queued; });
        return oldest ? std::optional(oldest->created) : std::nullopt;
    }
    JobKey insert(const JobRow& row, const std::string& spec) override {
        if (find(row.id)) refuse("job id '" + row.id + "' is taken");
        if (findByIdempotencyKey(row.idempotencyKey)) refuse("idempotency key is taken");
        rows[++last] = row;
        rows[last].key = last;
        specs[last] = spec;
        return last;
    }
    void update(const JobRow& row) override {
        auto& old = rows.at(row.key);
        checkMove(old.state, row.state);
        old = row;
    }
};

struct Frames : FrameTable {
    std::map<FrameKey, FrameRow> rows;
    std::map<TileKey, TileRow> tileRows;
    std::map<TileKey, LevelRow> levelRows;  // by samples
    std::map<TileKey, TileErrorRow> errorRows;

    std::optional<FrameRow> find(JobKey job, int32_t frame) const override {
        const auto at = rows.find({job, frame});
        return at == rows.end() ? std::nullopt : std::optional(at->second);
    }
    std::vector<FrameRow> listIf(const std::function<bool(const FrameRow&)>& matches) const {
        std::vector<FrameRow> found;
        for (const auto& [key, row] : rows) {
            if (matches(row)) found.push_back(row);
        }
        return found;
    }
    std::vector<FrameRow> list(JobKey job) const override {
        return listIf([&](const FrameRow& row) { return row.job == job; });
    }
    std::vector<FrameRow> listByState(FrameState state) const override {
        return listIf([&](const FrameRow& row) { return row.state == state; });
    }
    std::vector<FrameRow> listActive(JobKey job) const override {
        return listIf([&](const FrameRow& row) { return row.job == job && row.state == FrameState::active; });
    }
    std::vector<FrameRow> listWithWork(JobKey job) const override {
        return listIf([&](const FrameRow& row) {
            return row.job == job && row.state == FrameState::active &&
                   (row.passesQueued > 0 || row.levelsCreated < row.levels);
        });
    }
    size_t countActive(JobKey job) const override { return listActive(job).size(); }
    void insert(const FrameRow& row) override {
        if (!rows.emplace(FrameKey{row.job, row.frame}, row).second) refuse("the frame exists");
        for (uint32_t tile = 0; tile < row.tiles; ++tile) {
            tileRows[{row.job, row.frame, tile}] = {.job = row.job, .frame = row.frame, .tile = tile};
        }
    }
    void update(const FrameRow& row) override { rows.at({row.job, row.frame}) = row; }
    std::optional<TileRow> tile(JobKey job, int32_t frame, uint32_t tile) const override {
        const auto at = tileRows.find({job, frame, tile});
        return at == tileRows.end() ? std::nullopt : std::optional(at->second);
    }
    std::vector<TileRow> tiles(JobKey job, int32_t frame) const override {
        std::vector<TileRow> found;
        for (auto at = tileRows.lower_bound({job, frame, 0});
             at != tileRows.end() && at->second.job == job && at->second.frame == frame; ++at) {
            found.push_back(at->second);
        }
        return found;
    }
    void update(const TileRow& row) override {
        auto& old = tileRows.at({row.job, row.frame, row.tile});
        if (row.mergedSamples < old.mergedSamples) refuse("merged samples are never given up");
        old = row;
    }
    void dropTiles(JobKey job, int32_t frame) override { dropOfFrame(tileRows, job, frame); }
    void dropTileErrors(JobKey job, int32_t frame) override { dropOfFrame(errorRows, job, frame); }
    std::optional<TileErrorRow> tileError(JobKey job, int32_t frame, uint32_t tile) const override {
        const auto at = errorRows.find({job, frame, tile});
        return at == errorRows.end() ? std::nullopt : std::optional(at->second);
    }
    std::vector<TileErrorRow> tileErrors(JobKey job, int32_t frame) const override {
        std::vector<TileErrorRow> found;
        for (auto at = errorRows.lower_bound({job, frame, 0});
             at != errorRows.end() && at->second.job == job && at->second.frame == frame; ++at) {
            found.push_back(at->second);
        }
        return found;
    }
    void put(const TileErrorRow& row) override {
        errorRows[{row.job, row.frame, row.tile}] = row;
        errorRows[{row.job, row.frame, row.tile}].error.pixels = 0;
    }
    FrameWork work(JobKey job) const override {
        FrameWork sum;
        for (const FrameRow& row : list(job)) {
            sum.passes += row.passes;
            sum.pixelSamples += row.pixelSamples;
        }
        return sum;
    }
    std::optional<LevelRow> level(JobKey job, int32_t frame, uint32_t samples) const override {
        const auto at = levelRows.find({job, frame, samples});
        return at == levelRows.end() ? std::nullopt : std::optional(at->second);
    }
    std::vector<LevelRow> levels(JobKey job, int32_t frame) const override {
        std::vector<LevelRow> found;
        for (auto at = levelRows.lower_bound({job, frame, 0});
             at != levelRows.end() && at->second.job == job && at->second.frame == frame; ++at) {
            found.push_back(at->second);
        }
        return found;
    }
    void put(const LevelRow& row) override { levelRows[{row.job, row.frame, row.samples}] = row; }
};

struct Leases : LeaseTable {
    std::map<uint64_t, LeaseRow> rows;
    uint64_t last = 0;
    std::vector<FailureRow> failureRows;
    std::map<PassKey, uint64_t> deaths;
    const std::vector<ContributionRow>* contributions = nullptr;  // of the worker table, set by State

    std::optional<LeaseRow> find(const std::string& id) const override {
        for (const auto& [epoch, row] : rows) {
            if (row.id == id) return row;
        }
        return std::nullopt;
    }
    std::vector<LeaseRow> open() const override {
        std::vector<LeaseRow> found;
        for (const auto& [epoch, row] : rows) {
            if (row.state == LeaseState::open) found.push_back(row);
        }
        return found;
    }
    bool isOpen(uint64_t epoch) const {
        const auto at = rows.find(epoch);
        return at != rows.end() && at->second.state == LeaseState::open;
    }
    uint64_t lastEpoch() const override { return last; }
    void insert(const LeaseRow& row) override {
        if (!rows.emplace(row.epoch, row).second) refuse("the epoch is taken");
        last = std::max(last, row.epoch);
    }
    void close(uint64_t epoch, LeaseState state) override { rows.at(epoch).state = state; }
    uint64_t forgetClosedBefore(TimePoint granted, size_t limit) override {
        uint64_t forgotten = 0;
        return std::erase_if(rows, [&](const auto& at) {
            const bool spent = at.second.state != LeaseState::open && at.second.granted < granted;
            return spent && forgotten++ < limit;
        });
    }
    std::vector<LeaseRow> lost() const override {
        std::vector<LeaseRow> found;
        for (const auto& [epoch, row] : rows) {
            if (row.loss != Loss::none) found.push_back(row);
        }
        return found;
    }
    void setLoss(uint64_t epoch, Loss loss) override { rows.at(epoch).loss = loss; }
    void addDeaths(const LeaseRow& lease, int32_t count) override {
        for (const LeasedPass& pass : lease.passes) {
            uint64_t& held = deaths[{lease.job, lease.frame, pass.samples.first, pass.tile}];
            held = static_cast<uint64_t>(std::max<int64_t>(0, static_cast<int64_t>(held) + count));
        }
    }
    std::optional<DeadlyPass> deadly(JobKey job, uint64_t least) const override {
        for (auto at = deaths.lower_bound({job, INT32_MIN, 0, 0});
             at != deaths.end() && std::get<0>(at->first) == job; ++at) {
            const auto& [key, frame, first, tile] = at->first;
            if (at->second >= least) return DeadlyPass{frame, tile, first, at->second};
        }
        return std::nullopt;
    }
    void forgetDeaths(JobKey job) override {
        std::erase_if(deaths, [&](const auto& at) { return std::get<0>(at.first) == job; });
    }
    void addFailure(const FailureRow& row) override {
        for (FailureRow& old : failureRows) {
            if (old.job == row.job && old.frame == row.frame && old.tile == row.tile &&
                old.firstSample == row.firstSample && old.worker == row.worker) {
                old.message = row.message;
                old.reports += row.reports;
                return;
            }
        }
        failureRows.push_back(row);
    }
    std::vector<FailureRow> failures(JobKey job, int32_t frame, uint32_t tile,
                                     uint32_t first) const override {
        std::vector<FailureRow> found;
        for (const FailureRow& row : failureRows) {
            if (row.job == job && row.frame == frame && row.tile == tile && row.firstSample == first) {
                found.push_back(row);
            }
        }
        return found;
    }
    size_t jobsOnlyThisWorkerFailed(const std::string& worker) const override {
        std::set<JobKey> jobs;
        for (const FailureRow& row : failureRows) {
            const bool othersCould =
                std::any_of(contributions->begin(), contributions->end(), [&](const ContributionRow& c) {
                    return c.job == row.job && c.worker != worker && c.passes > 0;
                });
            if (row.worker == worker && othersCould) jobs.insert(row.job);
        }
        return jobs.size();
    }
};

struct Passes : PassTable {
    std::map<PassKey, PassRow> rows;
    const Leases* leases = nullptr;

    auto frameRange(JobKey job, int32_t frame, uint32_t from = 0) const {
        return std::pair(rows.lower_bound({job, frame, from, 0}),
                         rows.upper_bound({job, frame, UINT32_MAX, UINT32_MAX}));
    }
    std::optional<PassRow> find(JobKey job, int32_t frame, uint32_t tile, uint32_t first) const override {
        const auto at = rows.find({job, frame, first, tile});
        return at == rows.end() ? std::nullopt : std::optional(at->second);
    }
    std::optional<uint32_t> lowestQueued(JobKey job, int32_t frame, uint32_t from) const override {
        const auto [begin, end] = frameRange(job, frame, from);
        const auto at =
            std::find_if(begin, end, [](const auto& p) { return p.second.state == PassState::queued; });
        return at == end ? std::nullopt : std::optional(at->second.samples.first);
    }
    PassCounts counts(JobKey job, int32_t frame) const override {
        PassCounts counts;
        const auto [begin, end] = frameRange(job, frame);
        for (auto at = begin; at != end; ++at) {
            switch (at->second.state) {
                case PassState::queued: ++counts.queued; break;
                case PassState::leased: ++counts.leased; break;
                case PassState::merged: ++counts.merged; break;
                case PassState::failed: ++counts.failed; break;
            }
        }
        return counts;
    }
    std::vector<PassRow> listIf(const std::function<bool(const PassRow&)>& matches) const {
        std::vector<PassRow> found;
        for (const auto& [key, row] : rows) {
            if (matches(row)) found.push_back(row);
        }
        return found;
    }
    std::vector<PassRow> leasedWithoutLease(size_t limit) const override {
        auto found = listIf(
            [&](const PassRow& row) { return row.state == PassState::leased && !leases->isOpen(row.epoch); });
        found.resize(std::min(found.size(), limit));
        return found;
    }
    std::vector<PassRow> held() const override {
        return listIf([](const PassRow& row) { return row.held.has_value(); });
    }
    std::vector<PassRow> heldOf(JobKey job, int32_t frame, uint32_t tile) const override {
        return listIf([&](const PassRow& row) {
            return row.held && row.job == job && row.frame == frame && row.tile == tile;
        });
    }
    bool isHeld(const std::string& file) const override {
        return std::any_of(rows.begin(), rows.end(),
                           [&](const auto& at) { return at.second.held && at.second.held->file == file; });
    }
    std::optional<TimePoint> oldestQueued() const override {
        std::optional<TimePoint> oldest;
        for (const auto& [key, row] : rows) {
            if (row.state == PassState::queued)
                oldest = std::min(oldest.value_or(row.queuedAt), row.queuedAt);
        }
        return oldest;
    }
    void insertLevel(JobKey job, int32_t frame, SampleRange level, uint32_t tiles, TimePoint now) override {
        for (uint32_t tile = 0; tile < tiles; ++tile) {
            const PassRow row{
                .job = job, .frame = frame, .tile = tile, .samples = level, .held = {}, .queuedAt = now};
            if (!rows.emplace(PassKey{job, frame, level.first, tile}, row).second) refuse("the pass exists");
        }
    }
    void insert(JobKey job, int32_t frame, const std::vector<LeasedPass>& passes, TimePoint now) override {
        for (const LeasedPass& pass : passes) {
            const PassRow row{.job = job,
                              .frame = frame,
                              .tile = pass.tile,
                              .samples = pass.samples,
                              .held = {},
                              .queuedAt = now};
            if (!rows.emplace(PassKey{job, frame, pass.samples.first, pass.tile}, row).second)
                refuse("the pass exists");
        }
    }
    /// Whether the worker should not get a pass because it failed it and others have not yet tried.
    bool leftToOthers(const PassRow& row, const PassClaim& claim) const {
        const auto failures = leases->failures(row.job, row.frame, row.tile, row.samples.first);
        return failures.size() < claim.onlineWorkers &&
               std::any_of(failures.begin(), failures.end(),
                           [&](const FailureRow& failure) { return failure.worker == claim.worker; });
    }
    std::vector<LeasedPass> claim(const PassClaim& claim) override {
        std::vector<LeasedPass> taken;
        const auto end = rows.upper_bound({claim.job, claim.frame, claim.level.first, UINT32_MAX});
        for (auto at = rows.lower_bound({claim.job, claim.frame, claim.level.first, 0});
             at != end && taken.size() < claim.limit; ++at) {
            PassRow& row = at->second;
            if (row.state != PassState::queued || leftToOthers(row, claim)) continue;
            row.state = PassState::leased;
            row.epoch = claim.epoch;
            taken.push_back({row.tile, row.samples});
        }
        return taken;
    }
    void update(const PassRow& row) override {
        auto& old = rows.at({row.job, row.frame, row.samples.first, row.tile});
        checkMove(old.state, row.state);
        old = row;
    }
    uint64_t release(uint64_t epoch, TimePoint now) override {
        uint64_t released = 0;
        for (auto& [key, row] : rows) {
            if (row.state != PassState::leased || row.epoch != epoch) continue;
            row.state = PassState::queued;
            row.queuedAt = now;
            ++released;
        }
        return released;
    }
    void drop(JobKey job, int32_t frame, uint32_t belowFirst) override {
        std::erase_if(rows, [&](const auto& at) {
            return at.second.job == job && at.second.frame == frame && at.second.samples.first < belowFirst;
        });
    }
};

struct Workers : WorkerTable {
    std::map<std::string, WorkerRow> rows;
    std::vector<ContributionRow> contributionRows;
    std::map<std::pair<JobKey, std::string>, std::string> reportRows;

    std::vector<WorkerRow> list() const override {
        std::vector<WorkerRow> found;
        for (const auto& [id, row] : rows) found.push_back(row);
        return found;
    }
    void put(const WorkerRow& row) override { rows[row.hello.worker] = row; }
    void forgetSeenBefore(TimePoint lastSeen) override {
        std::erase_if(rows, [&](const auto& at) { return at.second.lastSeen < lastSeen; });
    }
    std::vector<ContributionRow> contributions(JobKey job) const override {
        std::vector<ContributionRow> found;
        for (const ContributionRow& row : contributionRows) {
            if (row.job == job) found.push_back(row);
        }
        return found;
    }
    void addContribution(const ContributionRow& row) override {
        for (ContributionRow& old : contributionRows) {
            if (old.job != row.job || old.worker != row.worker) continue;
            old.deviceSeconds += row.deviceSeconds;
            old.passes += row.passes;
            old.samples += row.samples;
            return;
        }
        contributionRows.push_back(row);
    }
    std::vector<ReportRow> reports(JobKey job) const override {
        std::vector<ReportRow> found;
        for (const auto& [key, json] : reportRows) {
            if (key.first == job) found.push_back({job, key.second, json});
        }
        return found;
    }
    void putReport(const ReportRow& row) override { reportRows[{row.job, row.worker}] = row.json; }
};

struct Events : EventTable {
    std::map<int64_t, EventRow> rows;
    int64_t last = 0;

    std::vector<EventRow> list(int64_t after, std::optional<JobKey> job, size_t limit) const override {
        std::vector<EventRow> found;
        for (auto at = rows.upper_bound(after); at != rows.end() && found.size() < limit; ++at) {
            if (!job || at->second.job == *job) found.push_back(at->second);
        }
        return found;
    }
    int64_t lastId() const override { return last; }
    int64_t add(const EventRow& row) override {
        rows[++last] = row;
        rows[last].id = last;
        return last;
    }
    uint64_t forgetBelow(int64_t id, size_t limit) override {
        uint64_t forgotten = 0;
        return std::erase_if(rows, [&](const auto& at) { return at.first < id && forgotten++ < limit; });
    }
};

struct Studies : StudyTable {
    std::map<int64_t, StudyRow> rows;
    std::map<std::pair<int64_t, uint32_t>, StudyCellRow> cellRows;

    std::optional<StudyRow> find(const std::string& id) const override {
        for (const auto& [key, row] : rows) {
            if (row.id == id) return row;
        }
        return std::nullopt;
    }
    std::vector<StudyRow> list(int64_t before, size_t limit) const override {
        std::vector<StudyRow> found;
        for (auto at = rows.rbegin(); at != rows.rend() && found.size() < limit; ++at) {
            if (at->first < before) found.push_back(at->second);
        }
        return found;
    }
    std::vector<StudyRow> open() const override {
        std::vector<StudyRow> found;
        for (const auto& [key, row] : rows) {
            if (!row.finished) found.push_back(row);
        }
        return found;
    }
    int64_t insert(const StudyRow& row) override {
        if (find(row.id)) refuse("study id '" + row.id + "' is taken");
        const int64_t key = rows.empty() ? 1 : rows.rbegin()->first + 1;
        rows[key] = row;
        return rows[key].key = key;
    }
    void update(const StudyRow& row) override {
        StudyRow& old = rows.at(row.key);
        if (old.state != row.state && old.state != StudyState::running) refuse("no such move of a study");
        old.state = row.state;
        old.finished = row.finished;
        old.fault = row.fault;
    }
    std::vector<StudyCellRow> cells(int64_t study) const override {
        std::vector<StudyCellRow> found;
        for (const auto& [key, row] : cellRows) {
            if (key.first == study) found.push_back({study, key.second, row.resultJson, ""});
        }
        return found;
    }
    std::optional<StudyCellRow> cell(int64_t study, uint32_t cell) const override {
        const auto at = cellRows.find({study, cell});
        return at == cellRows.end() ? std::nullopt : std::optional(at->second);
    }
    void putCell(const StudyCellRow& row) override {
        if (!rows.contains(row.study)) refuse("there is no such study");
        cellRows[{row.study, row.cell}] = row;
    }
};

}  // namespace

struct MemoryJobStore::State {
    Jobs jobs;
    Frames frames;
    Passes passes;
    Leases leases;
    Workers workers;
    Events events;
    Studies studies;

    State() { link(); }
    State(const State& other)
        : jobs(other.jobs),
          frames(other.frames),
          passes(other.passes),
          leases(other.leases),
          workers(other.workers),
          events(other.events),
          studies(other.studies) {
        link();
    }
    State& operator=(const State&) = delete;
    void link() {
        jobs.frames = &frames.rows;
        passes.leases = &leases;
        leases.contributions = &workers.contributionRows;
    }
    Tables tables() { return {jobs, frames, passes, leases, workers, events, studies}; }
};

MemoryJobStore::MemoryJobStore() : state_(std::make_shared<State>()) {}
MemoryJobStore::~MemoryJobStore() = default;

void MemoryJobStore::write(const std::function<void(Tables&)>& work) {
    const std::scoped_lock one(writing_);
    auto next = std::make_shared<State>(*state_);
    auto tables = next->tables();
    work(tables);
    const std::scoped_lock lock(mutex_);
    state_ = std::move(next);
}

void MemoryJobStore::read(const std::function<void(const ConstTables&)>& work) const {
    std::shared_ptr<const State> view;
    {
        const std::scoped_lock lock(mutex_);
        view = state_;
    }
    work(ConstTables(const_cast<State&>(*view).tables()));
}

}  // namespace tilefarm
