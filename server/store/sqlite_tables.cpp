#include "server/store/sqlite_tables.h"

#include <algorithm>

#include "server/store/sqlite_connection.h"
#include "sql/events.h"
#include "sql/frames.h"
#include "sql/jobs.h"
#include "sql/leases.h"
#include "sql/passes.h"
#include "sql/studies.h"
#include "sql/workers.h"

namespace tilefarm {
namespace {

struct Jobs : JobTable {
    Connection& c;
    explicit Jobs(Connection& connection) : c(connection) {}

    std::optional<JobRow> find(const std::string& id) const override {
        return c.query(sql::jobs::findById).set(":id", id).first<JobRow>();
    }
    std::optional<JobRow> find(JobKey key) const override {
        return c.query(sql::jobs::findByKey).set(":key", key).first<JobRow>();
    }
    std::optional<JobRow> findByIdempotencyKey(const std::string& key) const override {
        return c.query(sql::jobs::findByIdempotencyKey).set(":idempotency_key", key).first<JobRow>();
    }
    std::vector<JobRow> list(const JobQuery& query) const override {
        auto q = c.query(query.state ? sql::jobs::listInState : sql::jobs::list);
        if (query.state) q.set(":state", *query.state);
        return q.set(":before", query.before).set(":limit", query.limit).all<JobRow>();
    }
    std::string spec(JobKey key) const override {
        auto q = c.query(sql::jobs::spec);
        return q.set(":job", key).next() ? q.value<std::string>("json") : std::string{};
    }
    // Rows are read before `visit` runs, since it may change them; a short page first, because the
    // first job nearly always has work.
    void forEachLeasable(const std::function<bool(JobKey)>& visit) const override {
        constexpr int64_t kGrowth = 4;
        int64_t offset = 0;
        for (int64_t limit = 16;; offset += limit, limit *= kGrowth) {
            const auto keys = leasable(limit, offset);
            for (const JobKey key : keys) {
                if (!visit(key)) return;
            }
            if (static_cast<int64_t>(keys.size()) < limit) return;
        }
    }
    std::vector<JobKey> leasable(int64_t limit, int64_t offset) const {
        auto q = c.query(sql::jobs::leasable);
        q.set(":limit", limit).set(":offset", offset);
        std::vector<JobKey> keys;
        while (q.next()) keys.push_back(q.value<JobKey>("key"));
        return keys;
    }
    std::map<JobState, JobTotals> totals() const override {
        auto q = c.query(sql::jobs::totals);
        std::map<JobState, JobTotals> totals;
        while (q.next()) {
            totals[q.value<JobState>("state")] = {.jobs = q.value<uint64_t>("jobs"),
                                                  .passes = q.value<uint64_t>("passes"),
                                                  .passesMerged = q.value<uint64_t>("passes_merged"),
                                                  .passesQueued = q.value<uint64_t>("passes_queued"),
                                                  .passesLeased = q.value<uint64_t>("passes_leased")};
        }
        return totals;
    }
    std::optional<TimePoint> oldestQueued() const override {
        auto q = c.query(sql::jobs::oldestQueued);
        return q.next() ? std::optional(q.value<TimePoint>("created")) : std::nullopt;
    }
    JobKey insert(const JobRow& row, const std::string& spec) override {
        c.query(sql::jobs::insert).setRow(row).run();
        const JobKey key = c.db().getLastInsertRowid();
        c.query(sql::jobs::insertSpec).set(":job", key).set(":json", spec).run();
        return key;
    }
    void update(const JobRow& row) override { c.query(sql::jobs::update).setRow(row).run(); }
};

struct Frames : FrameTable {
    Connection& c;
    explicit Frames(Connection& connection) : c(connection) {}

    std::optional<FrameRow> find(JobKey job, int32_t frame) const override {
        return c.query(sql::frames::find).set(":job", job).set(":frame", frame).first<FrameRow>();
    }
    std::vector<FrameRow> list(JobKey job) const override {
        return c.query(sql::frames::list).set(":job", job).all<FrameRow>();
    }
    std::vector<FrameRow> listByState(FrameState state) const override {
        return c.query(sql::frames::listByState).set(":state", state).all<FrameRow>();
    }
    std::vector<FrameRow> listActive(JobKey job) const override {
        return c.query(sql::frames::listActive).set(":job", job).all<FrameRow>();
    }
    std::vector<FrameRow> listWithWork(JobKey job) const override {
        return c.query(sql::frames::listWithWork).set(":job", job).all<FrameRow>();
    }
    size_t countActive(JobKey job) const override {
        auto q = c.query(sql::frames::countActive);
        q.set(":job", job).next();
        return q.value<size_t>("frames");
    }
    void insert(const FrameRow& row) override {
        c.query(sql::frames::insert).setRow(row).run();
        c.query(sql::frames::insertTiles).setRow(row).run();
    }
    void update(const FrameRow& row) override { c.query(sql::frames::update).setRow(row).run(); }

    std::optional<TileRow> tile(JobKey job, int32_t frame, uint32_t tile) const override {
        auto q = c.query(sql::frames::tile);
        return q.set(":job", job).set(":frame", frame).set(":tile", tile).first<TileRow>();
    }
    std::vector<TileRow> tiles(JobKey job, int32_t frame) const override {
        return c.query(sql::frames::tiles).set(":job", job).set(":frame", frame).all<TileRow>();
    }
    void update(const TileRow& row) override { c.query(sql::frames::updateTile).setRow(row).run(); }
    void dropTiles(JobKey job, int32_t frame) override {
        c.query(sql::frames::dropTiles).set(":job", job).set(":frame", frame).run();
    }
    void dropTileErrors(JobKey job, int32_t frame) override {
        c.query(sql::frames::dropTileErrors).set(":job", job).set(":frame", frame).run();
    }
    std::optional<TileErrorRow> tileError(JobKey job, int32_t frame, uint32_t tile) const override {
        auto q = c.query(sql::frames::tileError);
        return q.set(":job", job).set(":frame", frame).set(":tile", tile).first<TileErrorRow>();
    }
    std::vector<TileErrorRow> tileErrors(JobKey job, int32_t frame) const override {
        return c.query(sql::frames::tileErrors).set(":job", job).set(":frame", frame).all<TileErrorRow>();
    }
    void put(const TileErrorRow& row) override { c.query(sql::frames::putTileError).setRow(row).run(); }
    FrameWork work(JobKey job) const override {
        auto q = c.query(sql::frames::work);
        q.set(":job", job).next();
        return {.passes = q.value<uint64_t>("passes"), .pixelSamples = q.value<uint64_t>("pixel_samples")};
    }

    std::optional<LevelRow> level(JobKey job, int32_t frame, uint32_t samples) const override {
        auto q = c.query(sql::frames::level);
        return q.set(":job", job).set(":frame", frame).set(":samples", samples).first<LevelRow>();
    }
    std::vector<LevelRow> levels(JobKey job, int32_t frame) const override {
        return c.query(sql::frames::levels).set(":job", job).set(":frame", frame).all<LevelRow>();
    }
    void put(const LevelRow& row) override { c.query(sql::frames::putLevel).setRow(row).run(); }
};

struct Passes : PassTable {
    Connection& c;
    explicit Passes(Connection& connection) : c(connection) {}

    std::optional<PassRow> find(JobKey job, int32_t frame, uint32_t tile, uint32_t first) const override {
        auto q = c.query(sql::passes::find);
        q.set(":job", job).set(":frame", frame).set(":first_sample", first).set(":tile", tile);
        return q.first<PassRow>();
    }
    std::optional<uint32_t> lowestQueued(JobKey job, int32_t frame, uint32_t from) const override {
        auto q = c.query(sql::passes::lowestQueued);
        q.set(":job", job).set(":frame", frame).set(":from", from);
        return q.next() ? std::optional(q.value<uint32_t>("first_sample")) : std::nullopt;
    }
    PassCounts counts(JobKey job, int32_t frame) const override {
        auto q = c.query(sql::passes::counts);
        q.set(":job", job).set(":frame", frame).next();
        return {.queued = q.value<uint64_t>("queued"),
                .leased = q.value<uint64_t>("leased"),
                .merged = q.value<uint64_t>("merged"),
                .failed = q.value<uint64_t>("failed")};
    }
    std::vector<PassRow> leasedWithoutLease(size_t limit) const override {
        return c.query(sql::passes::leasedWithoutLease).set(":limit", limit).all<PassRow>();
    }
    std::vector<PassRow> held() const override { return c.query(sql::passes::held).all<PassRow>(); }
    std::vector<PassRow> heldOf(JobKey job, int32_t frame, uint32_t tile) const override {
        auto q = c.query(sql::passes::heldOf);
        return q.set(":job", job).set(":frame", frame).set(":tile", tile).all<PassRow>();
    }
    bool isHeld(const std::string& file) const override {
        return c.query(sql::passes::isHeld).set(":held_file", file).next();
    }
    std::optional<TimePoint> oldestQueued() const override {
        auto q = c.query(sql::passes::oldestQueued);
        return q.next() ? std::optional(q.value<TimePoint>("oldest")) : std::nullopt;
    }
    void insertLevel(JobKey job, int32_t frame, SampleRange level, uint32_t tiles, TimePoint now) override {
        auto q = c.query(sql::passes::insertLevel);
        q.set(":job", job).set(":frame", frame).set(":tiles", tiles).set(":now", now);
        q.set(":first_sample", level.first).set(":samples", level.count).run();
    }
    void insert(JobKey job, int32_t frame, const std::vector<LeasedPass>& passes, TimePoint now) override {
        for (const LeasedPass& pass : passes) {
            auto q = c.query(sql::passes::insert);
            q.set(":job", job).set(":frame", frame).set(":tile", pass.tile).set(":now", now);
            q.set(":first_sample", pass.samples.first).set(":samples", pass.samples.count).run();
        }
    }
    std::vector<LeasedPass> claim(const PassClaim& claim) override {
        auto q = c.query(sql::passes::claim);
        q.set(":job", claim.job).set(":frame", claim.frame).set(":first_sample", claim.level.first);
        q.set(":limit", claim.limit).set(":epoch", claim.epoch);
        q.set(":worker", claim.worker).set(":online_workers", claim.onlineWorkers);
        auto taken = q.all<LeasedPass>();
        std::sort(taken.begin(), taken.end(), [](const auto& a, const auto& b) { return a.tile < b.tile; });
        return taken;
    }
    void update(const PassRow& row) override { c.query(sql::passes::update).setRow(row).run(); }
    uint64_t release(uint64_t epoch, TimePoint now) override {
        return c.query(sql::passes::release).set(":epoch", epoch).set(":now", now).run();
    }
    void drop(JobKey job, int32_t frame, uint32_t belowFirst) override {
        auto q = c.query(sql::passes::drop);
        q.set(":job", job).set(":frame", frame).set(":below", belowFirst).run();
    }
};

struct Leases : LeaseTable {
    Connection& c;
    explicit Leases(Connection& connection) : c(connection) {}

    std::optional<LeaseRow> find(const std::string& id) const override {
        return c.query(sql::leases::find).set(":id", id).first<LeaseRow>();
    }
    std::vector<LeaseRow> open() const override { return c.query(sql::leases::open).all<LeaseRow>(); }
    uint64_t lastEpoch() const override {
        auto q = c.query(sql::leases::lastEpoch);
        return q.next() ? q.value<uint64_t>("epoch") : 0;
    }
    void insert(const LeaseRow& row) override { c.query(sql::leases::insert).setRow(row).run(); }
    void close(uint64_t epoch, LeaseState state) override {
        c.query(sql::leases::close).set(":epoch", epoch).set(":state", state).run();
    }
    uint64_t forgetClosedBefore(TimePoint granted, size_t limit) override {
        return c.query(sql::leases::forgetClosedBefore).set(":granted", granted).set(":limit", limit).run();
    }
    std::vector<LeaseRow> lost() const override { return c.query(sql::leases::lost).all<LeaseRow>(); }
    void setLoss(uint64_t epoch, Loss loss) override {
        c.query(sql::leases::setLoss).set(":epoch", epoch).set(":loss", loss).run();
    }
    void addDeaths(const LeaseRow& lease, int32_t count) override {
        for (const LeasedPass& pass : lease.passes) {
            auto q = c.query(sql::leases::addDeaths);
            q.set(":job", lease.job).set(":frame", lease.frame);
            q.set(":first_sample", pass.samples.first).set(":tile", pass.tile).set(":count", count).run();
        }
    }
    std::optional<DeadlyPass> deadly(JobKey job, uint64_t least) const override {
        return c.query(sql::leases::deadly).set(":job", job).set(":least", least).first<DeadlyPass>();
    }
    void forgetDeaths(JobKey job) override { c.query(sql::leases::forgetDeaths).set(":job", job).run(); }
    void addFailure(const FailureRow& row) override { c.query(sql::leases::addFailure).setRow(row).run(); }
    std::vector<FailureRow> failures(JobKey job, int32_t frame, uint32_t tile,
                                     uint32_t first) const override {
        auto q = c.query(sql::leases::failures);
        q.set(":job", job).set(":frame", frame).set(":tile", tile).set(":first_sample", first);
        return q.all<FailureRow>();
    }
    size_t jobsOnlyThisWorkerFailed(const std::string& worker) const override {
        auto q = c.query(sql::leases::jobsOnlyThisWorkerFailed);
        q.set(":worker", worker).next();
        return q.value<size_t>("jobs");
    }
};

struct Workers : WorkerTable {
    Connection& c;
    explicit Workers(Connection& connection) : c(connection) {}

    std::vector<WorkerRow> list() const override { return c.query(sql::workers::list).all<WorkerRow>(); }
    void put(const WorkerRow& row) override { c.query(sql::workers::put).setRow(row).run(); }
    void forgetSeenBefore(TimePoint lastSeen) override {
        c.query(sql::workers::forgetSeenBefore).set(":last_seen", lastSeen).run();
    }
    std::vector<ContributionRow> contributions(JobKey job) const override {
        return c.query(sql::workers::contributions).set(":job", job).all<ContributionRow>();
    }
    void addContribution(const ContributionRow& row) override {
        c.query(sql::workers::addContribution).setRow(row).run();
    }
    std::vector<ReportRow> reports(JobKey job) const override {
        return c.query(sql::workers::reports).set(":job", job).all<ReportRow>();
    }
    void putReport(const ReportRow& row) override { c.query(sql::workers::putReport).setRow(row).run(); }
};

struct Events : EventTable {
    Connection& c;
    explicit Events(Connection& connection) : c(connection) {}

    std::vector<EventRow> list(int64_t after, std::optional<JobKey> job, size_t limit) const override {
        auto q = c.query(job ? sql::events::listOfJob : sql::events::list);
        if (job) q.set(":job", *job);
        return q.set(":after", after).set(":limit", limit).all<EventRow>();
    }
    int64_t lastId() const override {
        auto q = c.query(sql::events::lastId);
        return q.next() ? q.value<int64_t>("id") : 0;
    }
    int64_t add(const EventRow& row) override {
        c.query(sql::events::add).setRow(row).run();
        return c.db().getLastInsertRowid();
    }
    uint64_t forgetBelow(int64_t id, size_t limit) override {
        return c.query(sql::events::forgetBelow).set(":id", id).set(":limit", limit).run();
    }
};

struct Studies : StudyTable {
    Connection& c;
    explicit Studies(Connection& connection) : c(connection) {}

    std::optional<StudyRow> find(const std::string& id) const override {
        return c.query(sql::studies::find).set(":id", id).first<StudyRow>();
    }
    std::vector<StudyRow> list(int64_t before, size_t limit) const override {
        return c.query(sql::studies::list).set(":before", before).set(":limit", limit).all<StudyRow>();
    }
    std::vector<StudyRow> open() const override { return c.query(sql::studies::open).all<StudyRow>(); }
    int64_t insert(const StudyRow& row) override {
        c.query(sql::studies::insert).setRow(row).run();
        return c.db().getLastInsertRowid();
    }
    void update(const StudyRow& row) override { c.query(sql::studies::update).setRow(row).run(); }
    std::vector<StudyCellRow> cells(int64_t study) const override {
        return c.query(sql::studies::cells).set(":study", study).all<StudyCellRow>();
    }
    std::optional<StudyCellRow> cell(int64_t study, uint32_t cell) const override {
        return c.query(sql::studies::cell).set(":study", study).set(":cell", cell).first<StudyCellRow>();
    }
    void putCell(const StudyCellRow& row) override { c.query(sql::studies::putCell).setRow(row).run(); }
};

}  // namespace

struct SqliteTables::Impl {
    Jobs jobs;
    Frames frames;
    Passes passes;
    Leases leases;
    Workers workers;
    Events events;
    Studies studies;
    explicit Impl(Connection& c)
        : jobs(c), frames(c), passes(c), leases(c), workers(c), events(c), studies(c) {}
};

SqliteTables::SqliteTables(Connection& connection) : impl_(std::make_unique<Impl>(connection)) {}
SqliteTables::~SqliteTables() = default;
Tables SqliteTables::tables() {
    return {impl_->jobs,    impl_->frames, impl_->passes, impl_->leases,
            impl_->workers, impl_->events, impl_->studies};
}

}  // namespace tilefarm
