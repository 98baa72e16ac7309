#include <algorithm>

#include "server/queue/scheduler.h"

namespace tilefarm {
namespace {

constexpr Milliseconds kLeasesKept{std::chrono::hours(24)};
constexpr Milliseconds kWorkersKept{std::chrono::hours(24 * 7)};
constexpr size_t kPage = 100;           // jobs
constexpr size_t kRowsAtATime = 500;    // of one transaction, for which everybody waits
constexpr int kMostTransactions = 100;  // for one kind of rows; the next sweep goes on

std::string placeOf(const std::string& job, int32_t frame) {
    return "job " + job + ", frame " + std::to_string(frame);
}

// What of a job does not hold between two transactions, whatever crashed before.
struct JobDamage {
    std::vector<FrameRow> frames;  // as they should be
    std::vector<int32_t> stuck;    // frames
    std::optional<JobRow> job;     // as it should be
    bool none() const { return frames.empty() && stuck.empty() && !job; }
};

// Rows of complete levels are gone; all of theirs were merged.
uint64_t goneOf(const FrameRow& frame, const JobInfo& info) {
    uint64_t gone = 0;
    for (const SampleRange& level : info.schedule)
        gone += level.end() <= frame.samplesMerged ? frame.tiles : 0;
    return gone;
}

// Where every tile has levels of its own: those in its film, and early ones.
uint64_t mergedOf(const ConstTables& t, const FrameRow& frame, const JobInfo& info) {
    uint64_t merged = 0;
    for (const TileRow& tile : t.frames.tiles(frame.job, frame.frame)) {
        merged += passesUpTo(info.schedule, tile.mergedSamples);
        merged += t.passes.heldOf(frame.job, frame.frame, tile.tile).size();
    }
    return merged;
}

FrameRow countedFrame(const ConstTables& t, const JobInfo& info, FrameRow frame) {
    const PassCounts rows = t.passes.counts(frame.job, frame.frame);
    frame.passesQueued = rows.queued;
    frame.passesLeased = rows.leased;
    frame.passesMerged =
        info.spec.stop.decidesOnTheWay() ? mergedOf(t, frame, info) : goneOf(frame, info) + rows.merged;
    return frame;
}

bool sameCounts(const FrameRow& a, const FrameRow& b) {
    return a.passesQueued == b.passesQueued && a.passesLeased == b.passesLeased &&
           a.passesMerged == b.passesMerged;
}

// The tail of every stuck job: nothing queued, nothing leased, nothing left to create.
bool isStuck(const JobInfo& info, const FrameRow& frame) {
    return frame.levelsCreated == info.freeLevels && frame.passesQueued + frame.passesLeased == 0;
}

JobDamage damageOf(const ConstTables& t, const JobRow& job, const JobInfo& info) {
    JobDamage damage;
    uint64_t merged = 0;
    uint32_t done = 0;
    for (const FrameRow& frame : t.frames.list(job.key)) {
        const bool active = frame.state == FrameState::active;
        const FrameRow counted = active ? countedFrame(t, info, frame) : frame;
        if (!sameCounts(frame, counted)) damage.frames.push_back(counted);
        if (active && isStuck(info, counted)) damage.stuck.push_back(frame.frame);
        merged += counted.passesMerged;
        done += frame.state == FrameState::completed;
    }
    if (merged == job.passesMerged && done == job.framesDone) return damage;
    damage.job = job;
    damage.job->passesMerged = merged;
    damage.job->framesDone = done;
    return damage;
}

void mend(Tables& t, const JobRow& job, const JobDamage& damage, std::vector<Violation>& found) {
    for (const FrameRow& frame : damage.frames) {
        t.frames.update(frame);
        found.push_back({"frame-counts-match-passes", placeOf(job.id, frame.frame), true});
    }
    for (const int32_t frame : damage.stuck)
        found.push_back({"active-frame-has-work", placeOf(job.id, frame), false});
    if (!damage.job) return;
    t.jobs.update(*damage.job);
    found.push_back({"job-counts-match-frames", "job " + job.id, true});
}

bool unfinished(const std::optional<JobRow>& job) {
    return job && !isFinal(job->state);
}

}  // namespace

std::vector<Violation> Scheduler::sweep() {
    expire();
    std::vector<Violation> found;
    freeUnleasedPasses(found);
    for (const JobState state : {JobState::queued, JobState::running, JobState::paused}) {
        JobQuery query{.state = state, .before = INT64_MAX, .limit = kPage};
        for (auto page = jobKeys(query); !page.empty(); page = jobKeys(query)) {
            for (const JobKey key : page) sweepJob(key, found);
            query.before = page.back();
        }
    }
    closeUnwatchedLeases(found);
    forgetOldRows();
    return found;
}

std::vector<JobKey> Scheduler::jobKeys(const JobQuery& query) const {
    std::vector<JobKey> keys;
    store_.read([&](const ConstTables& t) {
        for (const JobRow& job : t.jobs.list(query)) keys.push_back(job.key);
    });
    return keys;
}

void Scheduler::freeUnleasedPasses(std::vector<Violation>& found) {
    const auto anyLeft = [&] {
        bool any = false;
        store_.read([&](const ConstTables& t) { any = !t.passes.leasedWithoutLease(1).empty(); });
        return any;
    };
    for (int i = 0; i < kMostTransactions && anyLeft(); ++i) {
        const std::scoped_lock lock(mutex_);
        write([&](Tables& t) {
            for (PassRow& pass : t.passes.leasedWithoutLease(kRowsAtATime)) {
                pass.state = PassState::queued;
                pass.queuedAt = clock_.now();
                t.passes.update(pass);
                found.push_back(
                    {"leased-pass-has-open-lease", placeOf(std::to_string(pass.job), pass.frame), true});
            }
        });
    }
}

// Rows are compared in a reader's view, for which nobody waits. Only damage is worth a look under the lock.
void Scheduler::sweepJob(JobKey key, std::vector<Violation>& found) {
    bool sound = true;
    store_.read([&](const ConstTables& t) {
        const auto job = t.jobs.find(key);
        if (unfinished(job)) sound = damageOf(t, *job, *catalog_.get(t, *job)).none();
    });
    if (sound) return;
    const std::scoped_lock lock(mutex_);
    write([&](Tables& t) {
        const auto job = t.jobs.find(key);
        if (unfinished(job)) mend(t, *job, damageOf(t, *job, *catalog_.get(t, *job)), found);
    });
}

// An open lease of the database that nobody watches would never expire.
void Scheduler::closeUnwatchedLeases(std::vector<Violation>& found) {
    std::vector<LeaseRow> open;
    store_.read([&](const ConstTables& t) { open = t.leases.open(); });
    const std::scoped_lock lock(mutex_);
    std::erase_if(open, [&](const LeaseRow& lease) { return open_.contains(lease.id); });
    if (open.empty()) return;
    write([&](Tables& t) {
        for (const LeaseRow& lease : open) {
            const auto now = t.leases.find(lease.id);
            if (!now || now->state != LeaseState::open) continue;
            giveUp(t, lease.id, LeaseState::expired);
            found.push_back({"open-lease-is-watched", "lease " + lease.id, true});
        }
    });
}

void Scheduler::forgetOldRows() {
    const TimePoint now = clock_.now();
    const auto inBatches = [&](const std::function<uint64_t(Tables&)>& forget) {
        uint64_t forgotten = kRowsAtATime;
        for (int i = 0; i < kMostTransactions && forgotten == kRowsAtATime; ++i)
            store_.write([&](Tables& t) { forgotten = forget(t); });
    };
    inBatches([&](Tables& t) { return t.leases.forgetClosedBefore(now - kLeasesKept, kRowsAtATime); });
    inBatches([&](Tables& t) {
        return t.events.forgetBelow(t.events.lastId() - config_.eventsKept, kRowsAtATime);
    });
    store_.write([&](Tables& t) { t.workers.forgetSeenBefore(now - kWorkersKept); });
    const std::scoped_lock lock(mutex_);
    store_.read([&](const ConstTables& t) {
        std::erase_if(lost_, [&](const auto& at) { return !t.leases.find(at.first); });
    });
    roster_.forgetSeenBefore(now - kWorkersKept);
}

}  // namespace tilefarm
