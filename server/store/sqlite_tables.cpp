#include "server/store/sqlite_tables.h"

#include <algorithm>
#include <cstring>

#include "server/store/text_list.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr const char* kPragmas = R"sql(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
PRAGMA mmap_size = 0;
PRAGMA foreign_keys = ON;
PRAGMA busy_timeout = 10000;
)sql";

struct Jobs : JobTable {
    Connection& c;
    explicit Jobs(Connection& connection) : c(connection) {}

    static JobRow row(const Query& q) {
        JobRow row;
        row.key = q.integer(0);
        row.id = q.text(1);
        row.state = jobStateFrom(q.text(2));
        row.priority = q.number<int32_t>(3);
        row.specJson = q.text(4);
        row.idempotencyKey = q.text(5);
        row.bodyDigest = q.text(6);
        row.created = q.time(7);
        row.started = q.maybeTime(8);
        row.finished = q.maybeTime(9);
        row.passes = q.number<uint64_t>(10);
        row.passesMerged = q.number<uint64_t>(11);
        row.pixelSamples = q.number<uint64_t>(12);
        row.pixelSamplesMerged = q.number<uint64_t>(13);
        row.frames = q.number<uint32_t>(14);
        row.framesStarted = q.number<uint32_t>(15);
        row.framesDone = q.number<uint32_t>(16);
        row.samplesMerged = q.number<uint32_t>(17);
        row.relativeError = q.maybeReal(18);
        row.deviceSeconds = q.real(19);
        row.droppedSamples = q.number<uint64_t>(20);
        row.faults = splitLines(q.text(21));
        row.rejectedPaths = q.number<uint64_t>(22);
        row.truncatedPaths = q.number<uint64_t>(23);
        row.faultSamples = splitLines(q.text(24));
        row.truncatedThroughput = q.real(25);
        row.clampedSamples = q.number<uint64_t>(26);
        row.clampedLuminance = q.real(27);
        row.keptLuminance = q.real(28);
        if (!q.null(29)) row.suspectFrame = q.number<int32_t>(29);
        row.diedOn = splitLines(q.text(30));
        row.setAside = q.text(31);
        row.lightsBehindGlass = q.number<uint64_t>(32);
        return row;
    }
    static std::optional<JobRow> first(Query& q) { return q.next() ? std::optional(row(q)) : std::nullopt; }
    std::optional<JobRow> find(const std::string& id) const override {
        auto q = c.query("SELECT * FROM jobs WHERE id = ?");
        return first(q.with(id));
    }
    std::optional<JobRow> find(JobKey key) const override {
        auto q = c.query("SELECT * FROM jobs WHERE key = ?");
        return first(q.with(key));
    }
    std::optional<JobRow> findByIdempotencyKey(const std::string& key) const override {
        auto q = c.query("SELECT * FROM jobs WHERE idempotency_key = ?");
        return first(q.with(key));
    }
    std::vector<JobRow> list(const JobQuery& query) const override {
        auto q = query.state
                     ? c.query("SELECT * FROM jobs WHERE state = ? AND key < ? ORDER BY key DESC LIMIT ?")
                     : c.query("SELECT * FROM jobs WHERE key < ? ORDER BY key DESC LIMIT ?");
        if (query.state) q.with(toString(*query.state));
        q.with(query.before, uint64_t{query.limit});
        std::vector<JobRow> found;
        while (q.next()) found.push_back(row(q));
        return found;
    }
    // Rows are read before `visit` runs, since it may change them; a short page first, because the
    // first job nearly always has work.
    void forEachLeasable(const std::function<bool(JobKey)>& visit) const override {
        const std::pair<int64_t, int64_t> pages[] = {{16, 0}, {-1, 16}};
        for (const auto& [limit, offset] : pages) {
            for (const JobKey key : leasable(limit, offset)) {
                if (!visit(key)) return;
            }
        }
    }
    std::vector<JobKey> leasable(int64_t limit, int64_t offset) const {
        auto q = c.query(
            "SELECT key FROM jobs INDEXED BY jobs_leasable WHERE state IN ('queued','running') "
            "ORDER BY priority DESC, key LIMIT ? OFFSET ?");
        q.with(limit, offset);
        std::vector<JobKey> keys;
        while (q.next()) keys.push_back(q.integer(0));
        return keys;
    }
    std::map<JobState, uint64_t> counts() const override {
        auto q = c.query("SELECT state, count(*) FROM jobs GROUP BY state");
        std::map<JobState, uint64_t> counts;
        while (q.next()) counts[jobStateFrom(q.text(0))] = q.number<uint64_t>(1);
        return counts;
    }
    static std::optional<std::string> keyOrNull(const JobRow& row) {
        return row.idempotencyKey.empty() ? std::nullopt : std::optional(row.idempotencyKey);
    }
    JobKey insert(const JobRow& row) override {
        auto q = c.query(
            "INSERT INTO jobs VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
        q.with(row.id, toString(row.state), row.priority, row.specJson, keyOrNull(row), row.bodyDigest,
               row.created, row.started, row.finished, row.passes, row.passesMerged, row.pixelSamples,
               row.pixelSamplesMerged, row.frames, row.framesStarted, row.framesDone, row.samplesMerged,
               row.relativeError, row.deviceSeconds, row.droppedSamples, joinLines(row.faults),
               row.rejectedPaths, row.truncatedPaths, joinLines(row.faultSamples), row.truncatedThroughput,
               row.clampedSamples, row.clampedLuminance, row.keptLuminance, row.suspectFrame,
               joinLines(row.diedOn), row.setAside, row.lightsBehindGlass)
            .run();
        return c.db().getLastInsertRowid();
    }
    void update(const JobRow& row) override {
        auto q = c.query(
            "UPDATE jobs SET state=?, priority=?, started=?, finished=?, passes_merged=?, "
            "pixel_samples_merged=?, frames_started=?, frames_done=?, samples_merged=?, "
            "relative_error=?, device_seconds=?, "
            "dropped_samples=?, faults=?, rejected_paths=?, truncated_paths=?, fault_samples=?, "
            "truncated_throughput=?, clamped_samples=?, clamped_luminance=?, kept_luminance=?, "
            "suspect_frame=?, died_on=?, set_aside=?, lights_behind_glass=? WHERE key=?");
        q.with(toString(row.state), row.priority, row.started, row.finished, row.passesMerged,
               row.pixelSamplesMerged, row.framesStarted, row.framesDone, row.samplesMerged,
               row.relativeError, row.deviceSeconds, row.droppedSamples, joinLines(row.faults),
               row.rejectedPaths, row.truncatedPaths, joinLines(row.faultSamples), row.truncatedThroughput,
               row.clampedSamples, row.clampedLuminance, row.keptLuminance, row.suspectFrame,
               joinLines(row.diedOn), row.setAside, row.lightsBehindGlass, row.key)
            .run();
    }
};

struct Frames : FrameTable {
    Connection& c;
    explicit Frames(Connection& connection) : c(connection) {}

    static FrameRow row(const Query& q) {
        FrameRow row;
        row.job = q.integer(0);
        row.frame = q.number<int32_t>(1);
        row.state = frameStateFrom(q.text(2));
        row.levels = q.number<uint32_t>(3);
        row.levelsCreated = q.number<uint32_t>(4);
        row.tiles = q.number<uint32_t>(5);
        row.passesMerged = q.number<uint64_t>(6);
        row.passesQueued = q.number<uint64_t>(7);
        row.passesLeased = q.number<uint64_t>(8);
        row.samplesMerged = q.number<uint32_t>(9);
        row.relativeError = q.maybeReal(10);
        row.deviceSeconds = q.real(11);
        row.droppedSamples = q.number<uint64_t>(12);
        row.revision = q.number<uint64_t>(13);
        row.exrSha256 = q.text(14);
        row.exrBytes = q.number<uint64_t>(15);
        return row;
    }
    static TileRow tileRow(const Query& q) {
        return {.job = q.integer(0),
                .frame = q.number<int32_t>(1),
                .tile = q.number<uint32_t>(2),
                .slot = q.number<uint32_t>(3),
                .mergedSamples = q.number<uint32_t>(4)};
    }
    static LevelRow levelRow(const Query& q) {
        return {.job = q.integer(0),
                .frame = q.number<int32_t>(1),
                .samples = q.number<uint32_t>(2),
                .tiles = q.number<uint32_t>(3),
                .relativeVariance = q.real(4),
                .droppedSamples = q.number<uint64_t>(5),
                .relativeError = q.maybeReal(6),
                .deviceSeconds = q.maybeReal(7)};
    }
    static std::vector<FrameRow> all(Query& q) {
        std::vector<FrameRow> found;
        while (q.next()) found.push_back(row(q));
        return found;
    }
    std::optional<FrameRow> find(JobKey job, int32_t frame) const override {
        auto q = c.query("SELECT * FROM frames WHERE job = ? AND frame = ?");
        return q.with(job, frame).next() ? std::optional(row(q)) : std::nullopt;
    }
    std::vector<FrameRow> list(JobKey job) const override {
        auto q = c.query("SELECT * FROM frames WHERE job = ? ORDER BY frame");
        return all(q.with(job));
    }
    std::vector<FrameRow> listByState(FrameState state) const override {
        auto q = c.query("SELECT * FROM frames WHERE state = ? ORDER BY job, frame");
        return all(q.with(toString(state)));
    }
    std::vector<FrameRow> listActive(JobKey job) const override {
        auto q = c.query(
            "SELECT * FROM frames INDEXED BY frames_by_state "
            "WHERE state = 'active' AND job = ? ORDER BY frame");
        return all(q.with(job));
    }
    void insert(const FrameRow& row) override {
        auto q = c.query("INSERT INTO frames VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
        q.with(row.job, row.frame, toString(row.state), row.levels, row.levelsCreated, row.tiles,
               row.passesMerged, row.passesQueued, row.passesLeased, row.samplesMerged, row.relativeError,
               row.deviceSeconds, row.droppedSamples, row.revision, row.exrSha256, row.exrBytes)
            .run();
        auto tiles = c.query(
            "WITH RECURSIVE t(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM t WHERE i + 1 < ?) "
            "INSERT INTO tiles SELECT ?, ?, i, 0, 0 FROM t");
        tiles.with(row.tiles, row.job, row.frame).run();
    }
    void update(const FrameRow& row) override {
        auto q = c.query(
            "UPDATE frames SET state=?, levels_created=?, passes_merged=?, passes_queued=?, "
            "passes_leased=?, samples_merged=?, relative_error=?, device_seconds=?, "
            "dropped_samples=?, revision=?, exr_sha256=?, exr_bytes=? WHERE job=? AND frame=?");
        q.with(toString(row.state), row.levelsCreated, row.passesMerged, row.passesQueued, row.passesLeased,
               row.samplesMerged, row.relativeError, row.deviceSeconds, row.droppedSamples, row.revision,
               row.exrSha256, row.exrBytes, row.job, row.frame)
            .run();
    }
    std::optional<TileRow> tile(JobKey job, int32_t frame, uint32_t tile) const override {
        auto q = c.query("SELECT * FROM tiles WHERE job = ? AND frame = ? AND tile = ?");
        return q.with(job, frame, tile).next() ? std::optional(tileRow(q)) : std::nullopt;
    }
    std::vector<TileRow> tiles(JobKey job, int32_t frame) const override {
        auto q = c.query("SELECT * FROM tiles WHERE job = ? AND frame = ? ORDER BY tile");
        q.with(job, frame);
        std::vector<TileRow> found;
        while (q.next()) found.push_back(tileRow(q));
        return found;
    }
    void update(const TileRow& row) override {
        auto q = c.query("UPDATE tiles SET slot=?, merged_samples=? WHERE job=? AND frame=? AND tile=?");
        q.with(row.slot, row.mergedSamples, row.job, row.frame, row.tile).run();
    }
    void dropTiles(JobKey job, int32_t frame) override {
        auto q = c.query("DELETE FROM tiles WHERE job = ? AND frame = ?");
        q.with(job, frame).run();
    }
    std::optional<LevelRow> level(JobKey job, int32_t frame, uint32_t samples) const override {
        auto q = c.query("SELECT * FROM levels WHERE job = ? AND frame = ? AND samples = ?");
        return q.with(job, frame, samples).next() ? std::optional(levelRow(q)) : std::nullopt;
    }
    std::vector<LevelRow> levels(JobKey job, int32_t frame) const override {
        auto q = c.query("SELECT * FROM levels WHERE job = ? AND frame = ? ORDER BY samples");
        q.with(job, frame);
        std::vector<LevelRow> found;
        while (q.next()) found.push_back(levelRow(q));
        return found;
    }
    void put(const LevelRow& row) override {
        auto q = c.query("INSERT OR REPLACE INTO levels VALUES (?,?,?,?,?,?,?,?)");
        q.with(row.job, row.frame, row.samples, row.tiles, row.relativeVariance, row.droppedSamples,
               row.relativeError, row.deviceSeconds)
            .run();
    }
};

struct Passes : PassTable {
    Connection& c;
    explicit Passes(Connection& connection) : c(connection) {}

    static PassRow row(const Query& q) {
        PassRow row;
        row.job = q.integer(0);
        row.frame = q.number<int32_t>(1);
        row.samples = {q.number<uint32_t>(2), q.number<uint32_t>(4)};
        row.tile = q.number<uint32_t>(3);
        row.state = passStateFrom(q.text(5));
        row.epoch = q.number<uint64_t>(6);
        if (!q.null(7)) row.held = HeldPass{q.text(7), q.number<uint64_t>(8)};
        row.queuedAt = q.time(9);
        return row;
    }
    static std::vector<PassRow> all(Query& q) {
        std::vector<PassRow> found;
        while (q.next()) found.push_back(row(q));
        return found;
    }
    std::optional<PassRow> find(JobKey job, int32_t frame, uint32_t tile, uint32_t first) const override {
        auto q =
            c.query("SELECT * FROM passes WHERE job = ? AND frame = ? AND first_sample = ? AND tile = ?");
        return q.with(job, frame, first, tile).next() ? std::optional(row(q)) : std::nullopt;
    }
    std::optional<uint32_t> lowestQueued(JobKey job, int32_t frame, uint32_t from) const override {
        auto q = c.query(
            "SELECT first_sample FROM passes INDEXED BY passes_queued "
            "WHERE job = ? AND frame = ? AND first_sample >= ? AND state = 'queued' "
            "ORDER BY first_sample, tile LIMIT 1");
        return q.with(job, frame, from).next() ? std::optional(q.number<uint32_t>(0)) : std::nullopt;
    }
    PassCounts counts(JobKey job, int32_t frame) const override {
        auto q = c.query(
            "SELECT coalesce(sum(state = 'queued'), 0), coalesce(sum(state = 'leased'), 0), "
            "coalesce(sum(state = 'merged'), 0), coalesce(sum(state = 'failed'), 0) "
            "FROM passes WHERE job = ? AND frame = ?");
        q.with(job, frame).next();
        return {q.number<uint64_t>(0), q.number<uint64_t>(1), q.number<uint64_t>(2), q.number<uint64_t>(3)};
    }
    std::vector<PassRow> leasedWithoutLease() const override {
        auto q = c.query(
            "SELECT * FROM passes INDEXED BY passes_leased WHERE state = 'leased' AND NOT EXISTS "
            "(SELECT 1 FROM leases WHERE leases.epoch = passes.epoch AND leases.state = 'open')");
        return all(q);
    }
    std::vector<PassRow> held() const override {
        auto q = c.query("SELECT * FROM passes INDEXED BY passes_held WHERE held_file IS NOT NULL");
        return all(q);
    }
    std::vector<PassRow> heldOf(JobKey job, int32_t frame, uint32_t tile) const override {
        auto q = c.query(
            "SELECT * FROM passes INDEXED BY passes_held_of_tile "
            "WHERE job = ? AND frame = ? AND tile = ? AND held_file IS NOT NULL ORDER BY first_sample");
        return all(q.with(job, frame, tile));
    }
    bool isHeld(const std::string& file) const override {
        auto q = c.query("SELECT 1 FROM passes INDEXED BY passes_held WHERE held_file = ? LIMIT 1");
        return q.with(file).next();
    }
    std::optional<TimePoint> oldestQueued() const override {
        auto q = c.query("SELECT min(queued_at) FROM passes INDEXED BY passes_queued WHERE state = 'queued'");
        return q.next() ? q.maybeTime(0) : std::nullopt;
    }
    void insertLevel(JobKey job, int32_t frame, SampleRange level, uint32_t tiles, TimePoint now) override {
        auto q = c.query(
            "WITH RECURSIVE t(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM t WHERE i + 1 < ?) "
            "INSERT INTO passes SELECT ?, ?, ?, i, ?, 'queued', 0, NULL, NULL, ? FROM t");
        q.with(tiles, job, frame, level.first, level.count, now).run();
    }
    std::vector<LeasedPass> claim(const PassClaim& claim) override {
        auto q = c.query(R"sql(
            UPDATE passes SET state = 'leased', epoch = ?5
             WHERE job = ?1 AND frame = ?2 AND first_sample = ?3 AND tile IN (
                SELECT p.tile FROM passes AS p INDEXED BY passes_queued
                 WHERE p.job = ?1 AND p.frame = ?2 AND p.first_sample = ?3 AND p.state = 'queued'
                   AND (NOT EXISTS (SELECT 1 FROM failures AS f WHERE f.job = ?1 AND f.frame = ?2
                                       AND f.tile = p.tile AND f.first_sample = ?3 AND f.worker = ?6)
                        OR (SELECT count(*) FROM failures AS f WHERE f.job = ?1 AND f.frame = ?2
                               AND f.tile = p.tile AND f.first_sample = ?3) >= ?7)
                 ORDER BY p.tile LIMIT ?4)
            RETURNING tile, samples)sql");
        q.with(claim.job, claim.frame, claim.level.first, uint64_t{claim.limit}, claim.epoch, claim.worker,
               uint64_t{claim.onlineWorkers});
        std::vector<LeasedPass> taken;
        while (q.next()) taken.push_back({q.number<uint32_t>(0), {claim.level.first, q.number<uint32_t>(1)}});
        std::sort(taken.begin(), taken.end(), [](const auto& a, const auto& b) { return a.tile < b.tile; });
        return taken;
    }
    void update(const PassRow& row) override {
        auto q = c.query(
            "UPDATE passes SET state=?, epoch=?, held_file=?, held_offset=?, queued_at=? "
            "WHERE job=? AND frame=? AND first_sample=? AND tile=?");
        const auto file = row.held ? std::optional(row.held->file) : std::nullopt;
        const auto offset = row.held ? std::optional(row.held->offset) : std::nullopt;
        q.with(toString(row.state), row.epoch, file, offset, row.queuedAt, row.job, row.frame,
               row.samples.first, row.tile)
            .run();
    }
    uint64_t release(uint64_t epoch, TimePoint now) override {
        auto q =
            c.query("UPDATE passes SET state = 'queued', queued_at = ? WHERE epoch = ? AND state = 'leased'");
        return q.with(now, epoch).run();
    }
    void drop(JobKey job, int32_t frame, uint32_t belowFirst) override {
        auto q = c.query("DELETE FROM passes WHERE job = ? AND frame = ? AND first_sample < ?");
        q.with(job, frame, belowFirst).run();
    }
};

std::vector<std::byte> packPasses(const std::vector<LeasedPass>& passes) {
    std::vector<std::byte> bytes(passes.size() * 3 * sizeof(uint32_t));
    std::byte* to = bytes.data();
    for (const LeasedPass& pass : passes) {
        const uint32_t values[] = {pass.tile, pass.samples.first, pass.samples.count};
        std::memcpy(to, values, sizeof values);
        to += sizeof values;
    }
    return bytes;
}

std::vector<LeasedPass> unpackPasses(const std::string& bytes) {
    std::vector<LeasedPass> passes(bytes.size() / (3 * sizeof(uint32_t)));
    const char* from = bytes.data();
    for (LeasedPass& pass : passes) {
        uint32_t values[3];
        std::memcpy(values, from, sizeof values);
        from += sizeof values;
        pass = {values[0], {values[1], values[2]}};
    }
    return passes;
}

struct Leases : LeaseTable {
    Connection& c;
    explicit Leases(Connection& connection) : c(connection) {}

    static LeaseRow row(const Query& q) {
        return {.epoch = q.number<uint64_t>(0),
                .id = q.text(1),
                .worker = q.text(2),
                .job = q.integer(3),
                .frame = q.number<int32_t>(4),
                .state = leaseStateFrom(q.text(5)),
                .granted = q.time(6),
                .passes = unpackPasses(q.text(7)),
                .session = q.text(8),
                .machine = q.text(9),
                .loss = lossFrom(q.text(10))};
    }
    static std::vector<LeaseRow> all(Query& q) {
        std::vector<LeaseRow> found;
        while (q.next()) found.push_back(row(q));
        return found;
    }
    std::optional<LeaseRow> find(const std::string& id) const override {
        auto q = c.query("SELECT * FROM leases WHERE id = ?");
        return q.with(id).next() ? std::optional(row(q)) : std::nullopt;
    }
    std::vector<LeaseRow> open() const override {
        auto q = c.query("SELECT * FROM leases WHERE state = 'open' ORDER BY epoch");
        return all(q);
    }
    uint64_t lastEpoch() const override {
        auto q = c.query("SELECT seq FROM sqlite_sequence WHERE name = 'leases'");
        return q.next() ? q.number<uint64_t>(0) : 0;
    }
    void insert(const LeaseRow& row) override {
        auto q = c.query("INSERT INTO leases VALUES (?,?,?,?,?,?,?,?,?,?,?)");
        q.with(row.epoch, row.id, row.worker, row.job, row.frame, toString(row.state), row.granted,
               packPasses(row.passes), row.session, row.machine, toString(row.loss))
            .run();
    }
    void close(uint64_t epoch, LeaseState state) override {
        auto q = c.query("UPDATE leases SET state = ? WHERE epoch = ?");
        q.with(toString(state), epoch).run();
    }
    void forgetClosedBefore(TimePoint granted) override {
        auto q = c.query("DELETE FROM leases WHERE state <> 'open' AND granted < ?");
        q.with(granted).run();
    }
    std::vector<LeaseRow> lost() const override {
        auto q = c.query("SELECT * FROM leases INDEXED BY leases_lost WHERE loss <> 'none' ORDER BY epoch");
        return all(q);
    }
    void setLoss(uint64_t epoch, Loss loss) override {
        auto q = c.query("UPDATE leases SET loss = ? WHERE epoch = ?");
        q.with(toString(loss), epoch).run();
    }
    void addDeaths(const LeaseRow& lease, int32_t count) override {
        for (const LeasedPass& pass : lease.passes) {
            auto q = c.query(
                "INSERT INTO deaths VALUES (?1,?2,?3,?4,max(0,?5)) "
                "ON CONFLICT DO UPDATE SET deaths = max(0, deaths + ?5)");
            q.with(lease.job, lease.frame, pass.samples.first, pass.tile, count).run();
        }
    }
    std::optional<DeadlyPass> deadly(JobKey job, uint64_t least) const override {
        auto q = c.query(
            "SELECT frame, tile, first_sample, deaths FROM deaths WHERE job = ? AND deaths >= ? "
            "ORDER BY frame, first_sample, tile LIMIT 1");
        if (!q.with(job, least).next()) return std::nullopt;
        return DeadlyPass{q.number<int32_t>(0), q.number<uint32_t>(1), q.number<uint32_t>(2),
                          q.number<uint64_t>(3)};
    }
    void forgetDeaths(JobKey job) override {
        auto q = c.query("DELETE FROM deaths WHERE job = ?");
        q.with(job).run();
    }
    void addFailure(const FailureRow& row) override {
        auto q = c.query(
            "INSERT INTO failures VALUES (?,?,?,?,?,?,?) ON CONFLICT DO UPDATE "
            "SET message = excluded.message, reports = reports + excluded.reports");
        q.with(row.job, row.frame, row.tile, row.firstSample, row.worker, row.message, row.reports).run();
    }
    std::vector<FailureRow> failures(JobKey job, int32_t frame, uint32_t tile,
                                     uint32_t first) const override {
        auto q = c.query(
            "SELECT worker, message, reports FROM failures "
            "WHERE job = ? AND frame = ? AND tile = ? AND first_sample = ?");
        q.with(job, frame, tile, first);
        std::vector<FailureRow> found;
        while (q.next()) {
            found.push_back({job, frame, tile, first, q.text(0), q.text(1), q.number<uint32_t>(2)});
        }
        return found;
    }
    size_t jobsOnlyThisWorkerFailed(const std::string& worker) const override {
        auto q = c.query(
            "SELECT count(DISTINCT f.job) FROM failures AS f WHERE f.worker = ?1 AND EXISTS "
            "(SELECT 1 FROM contributions AS c WHERE c.job = f.job AND c.worker <> ?1 AND c.passes > 0)");
        q.with(worker).next();
        return q.number<size_t>(0);
    }
};

struct Workers : WorkerTable {
    Connection& c;
    explicit Workers(Connection& connection) : c(connection) {}

    std::vector<WorkerRow> list() const override {
        auto q = c.query("SELECT * FROM workers ORDER BY worker");
        std::vector<WorkerRow> found;
        while (q.next()) {
            found.push_back({.hello = {q.text(0), q.text(1), q.text(2), q.text(3), q.text(4)},
                             .state = workerStateFrom(q.text(5)),
                             .reason = q.text(6),
                             .firstSeen = q.time(7),
                             .lastSeen = q.time(8)});
        }
        return found;
    }
    void put(const WorkerRow& row) override {
        auto q = c.query("INSERT OR REPLACE INTO workers VALUES (?,?,?,?,?,?,?,?,?)");
        q.with(row.hello.worker, row.hello.host, row.hello.device, row.hello.driver, row.hello.version,
               toString(row.state), row.reason, row.firstSeen, row.lastSeen)
            .run();
    }
    void forgetSeenBefore(TimePoint lastSeen) override {
        auto q = c.query("DELETE FROM workers WHERE last_seen < ?");
        q.with(lastSeen).run();
    }
    std::vector<ContributionRow> contributions(JobKey job) const override {
        auto q = c.query("SELECT * FROM contributions WHERE job = ? ORDER BY worker");
        q.with(job);
        std::vector<ContributionRow> found;
        while (q.next()) {
            found.push_back(
                {q.integer(0), q.text(1), q.real(2), q.number<uint64_t>(3), q.number<uint64_t>(4)});
        }
        return found;
    }
    void addContribution(const ContributionRow& row) override {
        auto q = c.query(
            "INSERT INTO contributions VALUES (?,?,?,?,?) ON CONFLICT DO UPDATE SET "
            "device_seconds = device_seconds + excluded.device_seconds, "
            "passes = passes + excluded.passes, samples = samples + excluded.samples");
        q.with(row.job, row.worker, row.deviceSeconds, row.passes, row.samples).run();
    }
    std::vector<ReportRow> reports(JobKey job) const override {
        auto q = c.query("SELECT worker, json FROM reports WHERE job = ? ORDER BY worker");
        q.with(job);
        std::vector<ReportRow> found;
        while (q.next()) found.push_back({job, q.text(0), q.text(1)});
        return found;
    }
    void putReport(const ReportRow& row) override {
        auto q = c.query("INSERT OR REPLACE INTO reports VALUES (?,?,?)");
        q.with(row.job, row.worker, row.json).run();
    }
};

struct Events : EventTable {
    Connection& c;
    explicit Events(Connection& connection) : c(connection) {}

    std::vector<EventRow> list(int64_t after, std::optional<JobKey> job, size_t limit) const override {
        auto q = job ? c.query("SELECT * FROM events WHERE job = ? AND id > ? ORDER BY id LIMIT ?")
                     : c.query("SELECT * FROM events WHERE id > ? ORDER BY id LIMIT ?");
        if (job) q.with(*job);
        q.with(after, uint64_t{limit});
        std::vector<EventRow> found;
        while (q.next()) {
            found.push_back({q.integer(0), q.integer(1), q.text(2), q.time(3), q.text(4), q.text(5)});
        }
        return found;
    }
    int64_t lastId() const override {
        auto q = c.query("SELECT coalesce(max(seq), 0) FROM sqlite_sequence WHERE name = 'events'");
        return q.next() ? q.integer(0) : 0;
    }
    int64_t add(const EventRow& row) override {
        auto q = c.query("INSERT INTO events VALUES (NULL,?,?,?,?,?)");
        q.with(row.job, row.jobId, row.at, row.type, row.json).run();
        return c.db().getLastInsertRowid();
    }
    void forgetBelow(int64_t id) override {
        auto q = c.query("DELETE FROM events WHERE id < ?");
        q.with(id).run();
    }
};

}  // namespace

Connection::Connection(const std::string& file, bool writer)
    : db_(file, SQLite::OPEN_READWRITE | (writer ? SQLite::OPEN_CREATE : 0)) {
    db_.exec(kPragmas);
    if (!writer) db_.exec("PRAGMA query_only = ON");
}

Query Connection::query(const char* sql) {
    auto& statement = statements_[sql];
    if (!statement) statement = std::make_unique<SQLite::Statement>(db_, sql);
    statement->clearBindings();
    return Query(*statement);
}

std::vector<std::string> Connection::prepared() const {
    std::vector<std::string> sql;
    for (const auto& [literal, statement] : statements_) sql.push_back(statement->getQuery());
    return sql;
}

struct SqliteTables::Impl {
    Jobs jobs;
    Frames frames;
    Passes passes;
    Leases leases;
    Workers workers;
    Events events;
    explicit Impl(Connection& c) : jobs(c), frames(c), passes(c), leases(c), workers(c), events(c) {}
};

SqliteTables::SqliteTables(Connection& connection) : impl_(std::make_unique<Impl>(connection)) {}
SqliteTables::~SqliteTables() = default;
Tables SqliteTables::tables() {
    return {impl_->jobs, impl_->frames, impl_->passes, impl_->leases, impl_->workers, impl_->events};
}

}  // namespace tilefarm
