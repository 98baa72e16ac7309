#include <algorithm>
#include <cmath>

#include "server/queue/event_json.h"
#include "server/queue/scheduler.h"
#include "server/store/file.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr double kShortestWant = 1, kLongestWant = 10;  // seconds
constexpr size_t kLongestMessage = 2000;

// Work of one pass of a whole tile; those at the edges are less, which only makes a lease shorter.
uint64_t tilePixels(const ImageSpec& image) {
    return uint64_t{std::min(image.tileSize, image.width)} * std::min(image.tileSize, image.height);
}

}  // namespace

std::variant<Lease, NoLease> Scheduler::lease(const WorkerHello& hello, double wantSeconds) {
    expire();
    const std::scoped_lock lock(mutex_);
    bury(hello.ended);
    heard(sessionOf(hello));
    const bool store = roster_.seen(hello, clock_.now());
    const WorkerRow& worker = *roster_.find(hello.worker);
    const bool quarantined = worker.state == WorkerState::quarantined;
    std::optional<Lease> lease;
    write([&](Tables& t) {
        if (store) t.workers.put(worker);
        if (quarantined || inTrial(sessionOf(hello))) return;
        t.jobs.forEachLeasable([&](JobKey key) {
            const JobRow job = *t.jobs.find(key);
            const Turn turn = turnOf(job, hello);
            if (turn != Turn::now) return turn == Turn::later;
            lease = leaseFrom(t, job, hello, std::clamp(wantSeconds, kShortestWant, kLongestWant));
            return !lease;
        });
    });
    if (quarantined) return NoLease{config_.leaseTime, "quarantined: " + worker.reason};
    if (!lease) return NoLease{config_.idleRetry, {}};
    return *std::move(lease);
}

std::optional<Lease> Scheduler::leaseFrom(Tables& t, JobRow job, const WorkerHello& hello,
                                          double wantSeconds) {
    const auto info = catalog_.get(t, job);
    const uint64_t epoch = t.leases.lastEpoch() + 1;

    auto frames = t.frames.listWithWork(job.key);
    const Budget budget = budgetFor(job, *info, frames, hello.worker, wantSeconds);
    const bool trial = job.suspectFrame.has_value();
    if (trial) std::erase_if(frames, [&](const FrameRow& frame) { return frame.frame != *job.suspectFrame; });
    const size_t mostActive = 8 + roster_.online(clock_.now());  // the rest stay without rows
    for (size_t i = 0;; ++i) {
        if (i == frames.size()) {
            if (trial || job.framesStarted == job.frames || t.frames.countActive(job.key) >= mostActive)
                return std::nullopt;
            frames.push_back(startFrame(t, job, *info));
        }
        auto passes = takePasses(t, frames[i], *info, hello.worker, epoch, budget);
        if (!passes.empty()) return grant(t, job, *info, frames[i], hello, epoch, std::move(passes));
    }
}

// A modest first lease, then by measured speed. Near a job's end a lease holds at most half of what
// is fair, so that the others do not wait for one worker's last big lease.
Scheduler::Budget Scheduler::budgetFor(const JobRow& job, const JobInfo& info,
                                       const std::vector<FrameRow>& frames, const std::string& worker,
                                       double wantSeconds) {
    const double rate = roster_.rate(worker, job.key);
    const double samples = rate > 0 ? rate * wantSeconds : static_cast<double>(config_.firstLeaseSamples);
    Budget budget{samples, config_.mostPixelsPerLease, UINT64_MAX};
    const size_t online = roster_.online(clock_.now());
    if (online > 1) {
        const uint64_t done = std::min(job.passes, job.passesMerged + job.passesLeased);
        uint64_t left = job.passes - done;
        if (const uint64_t soon = passesBeforeFixedPoints(info, frames)) left = std::min(left, soon);
        budget.passes = std::max<uint64_t>(1, (left + 2 * online - 1) / (2 * online));
    }
    // A pass is never split; a tile larger than the limit still goes out, one pass at a time.
    budget.pixels = std::max(budget.pixels, tilePixels(info.spec.image));
    return budget;
}

FrameRow Scheduler::startFrame(Tables& t, JobRow& job, const JobInfo& info) {
    FrameRow frame;
    frame.job = job.key;
    frame.frame = info.frame(job.framesStarted);
    frame.levels = static_cast<uint32_t>(info.schedule.size());
    frame.tiles = info.grid.count();
    frame.started = clock_.now();
    const FrameWork work = workOfNext(t, job, info);
    frame.passes = work.passes;
    frame.pixelSamples = work.pixelSamples;
    t.frames.insert(frame);
    ++job.framesStarted;
    t.jobs.update(job);
    note(t, job, "frame", frameStateJson(frame));
    return frame;
}

std::vector<LeasedPass> Scheduler::takePasses(Tables& t, FrameRow& frame, const JobInfo& info,
                                              const std::string& worker, uint64_t epoch, Budget budget) {
    const uint64_t pixels = tilePixels(info.spec.image);
    std::vector<LeasedPass> taken;
    for (uint32_t from = 0; budget.pixels >= pixels && budget.passes > 0;) {
        // 1. The lowest level that has queued passes; a new level's rows are made when all are out.
        auto first =
            frame.passesQueued > 0 ? t.passes.lowestQueued(frame.job, frame.frame, from) : std::nullopt;
        if (!first && frame.levelsCreated == frame.levels) break;
        if (!first) {
            const SampleRange& next = info.schedule[frame.levelsCreated];
            if (!taken.empty() && budget.samples < static_cast<double>(pixels) * next.count) break;
            ++frame.levelsCreated;
            if (frame.levelsCreated == info.freeLevels) frame.levelsCreated = frame.levels;  // decided later
            t.passes.insertLevel(frame.job, frame.frame, next, frame.tiles, clock_.now());
            frame.passesQueued += frame.tiles;
            first = next.first;
        }
        const SampleRange level = *info.level(*first);

        // 2. As many of its passes as the budget holds, at least one in all.
        const double cost = static_cast<double>(pixels) * level.count;
        const auto affordable = static_cast<uint64_t>(std::max(0.0, budget.samples) / cost);
        const uint64_t wanted = std::min({std::max<uint64_t>(affordable, taken.empty() ? 1 : 0),
                                          budget.pixels / pixels, budget.passes, uint64_t{frame.tiles}});
        if (wanted == 0) break;
        const auto got = t.passes.claim({.job = frame.job,
                                         .frame = frame.frame,
                                         .epoch = epoch,
                                         .level = level,
                                         .limit = wanted,
                                         .worker = worker,
                                         .onlineWorkers = roster_.online(clock_.now())});
        taken.insert(taken.end(), got.begin(), got.end());
        frame.passesQueued -= got.size();
        frame.passesLeased += got.size();
        budget.samples -= cost * static_cast<double>(got.size());
        budget.pixels -= pixels * got.size();
        budget.passes -= got.size();
        from = level.end();
    }
    t.frames.update(frame);
    return taken;
}

Lease Scheduler::grant(Tables& t, JobRow& job, const JobInfo& info, const FrameRow& frame,
                       const WorkerHello& hello, uint64_t epoch, std::vector<LeasedPass> passes) {
    if (job.state == JobState::queued) {
        job.state = JobState::running;
        job.started = clock_.now();
        t.jobs.update(job);
        noteJobState(t, job);
    }
    Lease lease;
    lease.id = "l" + randomHex(16);
    lease.epoch = epoch;
    lease.jobId = job.id;
    lease.spec = info.spec;
    lease.frame = frame.frame;
    lease.passes = std::move(passes);
    lease.expiresInMs = static_cast<uint32_t>(config_.leaseTime.count());
    lease.renewEveryMs = lease.expiresInMs / 3;
    t.leases.insert({.epoch = epoch,
                     .id = lease.id,
                     .worker = hello.worker,
                     .job = job.key,
                     .frame = frame.frame,
                     .state = LeaseState::open,
                     .granted = clock_.now(),
                     .passes = lease.passes,
                     .session = sessionOf(hello),
                     .machine = machineOf(hello)});
    open_[lease.id] = {.epoch = epoch,
                       .job = job.key,
                       .worker = hello.worker,
                       .deadline = clock_.now() + config_.leaseTime,
                       .session = sessionOf(hello),
                       .alone = job.suspectFrame.has_value(),
                       .frameRevision = frame.revision};
    return lease;
}

Scheduler::OpenLease& Scheduler::openLease(const std::string& leaseId, uint64_t epoch) {
    heardOfLease(leaseId);
    const auto at = open_.find(leaseId);
    if (at == open_.end() || at->second.epoch != epoch) explainLost(leaseId, epoch);
    roster_.seen(at->second.worker, clock_.now());
    return at->second;
}

void Scheduler::explainLost(const std::string& leaseId, uint64_t epoch) {
    std::optional<LeaseRow> lease;
    std::optional<JobRow> job;
    store_.read([&](const ConstTables& t) {
        lease = t.leases.find(leaseId);
        if (lease) job = t.jobs.find(lease->job);
    });
    if (!lease) throw Error(ErrorCode::notFound, "there is no lease '" + leaseId + "'");
    if (job && job->state == JobState::canceled) {
        throw Error(ErrorCode::gone, "job '" + job->id + "' was canceled");
    }
    throw Error(ErrorCode::conflict,
                lease->epoch != epoch ? "lease '" + leaseId + "' has a different epoch"
                                      : "lease '" + leaseId + "' is " + std::string(toString(lease->state)));
}

void Scheduler::renew(const std::string& leaseId, uint64_t epoch) {
    const std::scoped_lock lock(mutex_);
    openLease(leaseId, epoch).deadline = clock_.now() + config_.leaseTime;
}

// Passes of a lease that are still on loan go back to the queue; how many.
uint64_t Scheduler::giveUp(Tables& t, const std::string& leaseId, LeaseState state) {
    const auto lease = t.leases.find(leaseId);
    if (!lease) return 0;  // its grant was not committed (a full disk)
    t.leases.close(lease->epoch, state);
    const uint64_t released = t.passes.release(lease->epoch, clock_.now());
    if (released == 0) return 0;
    FrameRow frame = *t.frames.find(lease->job, lease->frame);
    frame.passesLeased -= std::min(frame.passesLeased, released);
    frame.passesQueued += released;
    t.frames.update(frame);
    return released;
}

void Scheduler::handBack(const std::string& leaseId, uint64_t epoch) {
    const std::scoped_lock lock(mutex_);
    openLease(leaseId, epoch);
    write([&](Tables& t) { giveUp(t, leaseId, LeaseState::returned); });
    open_.erase(leaseId);
}

void Scheduler::expire() {
    const std::scoped_lock lock(mutex_);
    loseLeases([now = clock_.now()](const OpenLease& lease) { return lease.deadline <= now; });
}

void Scheduler::putReport(const std::string& leaseId, uint64_t epoch, const std::string& report) {
    const std::scoped_lock lock(mutex_);
    const OpenLease lease = openLease(leaseId, epoch);
    write([&](Tables& t) { t.workers.putReport({lease.job, lease.worker, report}); });
}

void Scheduler::reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message) {
    const std::scoped_lock lock(mutex_);
    const std::string worker = openLease(leaseId, epoch).worker;
    write([&](Tables& t) {
        const LeaseRow lease = *t.leases.find(leaseId);
        failLeasedPasses(t, lease, message.substr(0, kLongestMessage));
        giveUp(t, leaseId, LeaseState::failed);
        quarantineIfAlone(t, worker);
    });
    open_.erase(leaseId);
}

void Scheduler::failLeasedPasses(Tables& t, const LeaseRow& lease, const std::string& message) {
    std::optional<PassRow> hopeless;
    for (const LeasedPass& leased : lease.passes) {
        auto pass = t.passes.find(lease.job, lease.frame, leased.tile, leased.samples.first);
        if (!pass || pass->state != PassState::leased || pass->epoch != lease.epoch) continue;
        if (failPass(t, *pass, lease.worker, message) && !hopeless) hopeless = pass;
    }
    JobRow job = *t.jobs.find(lease.job);
    if (!hopeless || !canMove(job.state, JobState::failed)) return;
    job.faults.push_back("frame " + std::to_string(hopeless->frame) + ", tile " +
                         std::to_string(hopeless->tile) + ", samples from " +
                         std::to_string(hopeless->samples.first) + ": " + message);
    endJob(t, job, JobState::failed);
}

// Whether the pass has failed for good: by several distinct workers, or thrice by all there are.
bool Scheduler::failPass(Tables& t, PassRow& pass, const std::string& worker, const std::string& message) {
    t.leases.addFailure({pass.job, pass.frame, pass.tile, pass.samples.first, worker, message, 1});
    const auto failures = t.leases.failures(pass.job, pass.frame, pass.tile, pass.samples.first);
    size_t reports = 0;
    for (const FailureRow& failure : failures) reports += failure.reports;
    const bool byAll = failures.size() >= roster_.online(clock_.now()) && reports >= config_.failingWorkers;
    if (failures.size() < config_.failingWorkers && !byAll) return false;
    pass.state = PassState::failed;
    t.passes.update(pass);
    return true;
}

// A worker that fails where others succeed is to blame itself; one that fails where all fail is not.
void Scheduler::quarantineIfAlone(Tables& t, const std::string& worker) {
    WorkerRow* row = roster_.find(worker);
    const size_t jobs = t.leases.jobsOnlyThisWorkerFailed(worker);
    if (row == nullptr || row->state == WorkerState::quarantined || jobs < config_.quarantineJobs) return;
    row->state = WorkerState::quarantined;
    row->reason = "failed on " + std::to_string(jobs) + " jobs that other workers could render";
    t.workers.put(*row);
    note(t, {}, "worker", workerJson(*row));
}

}  // namespace tilefarm
