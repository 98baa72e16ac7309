#include <algorithm>

#include "server/queue/scheduler.h"

namespace tilefarm {
namespace {

constexpr Milliseconds kLeasesKept{std::chrono::hours(24)};
constexpr Milliseconds kWorkersKept{std::chrono::hours(24 * 7)};

std::string placeOf(const std::string& job, int32_t frame) {
    return "job " + job + ", frame " + std::to_string(frame);
}

// What has to hold between two transactions, whatever crashed before. Each check names itself.
class Sweeper {
public:
    Sweeper(Tables& tables, JobCatalog& catalog, TimePoint now) : t(tables), catalog_(catalog), now_(now) {}

    std::vector<Violation> run() {
        leasedPassHasOpenLease();
        for (const JobState state : {JobState::queued, JobState::running, JobState::paused}) {
            forEachJob(state, [&](const JobRow& job) { checkUnfinished(job); });
        }
        return std::move(found_);
    }

private:
    void forEachJob(JobState state, const std::function<void(const JobRow&)>& check) {
        JobQuery query{.state = state, .before = INT64_MAX, .limit = 100};
        for (auto page = t.jobs.list(query); !page.empty(); page = t.jobs.list(query)) {
            for (const JobRow& job : page) check(job);
            query.before = page.back().key;
        }
    }

    void leasedPassHasOpenLease() {
        for (PassRow& pass : t.passes.leasedWithoutLease()) {
            pass.state = PassState::queued;
            pass.queuedAt = now_;
            t.passes.update(pass);
            report("leased-pass-has-open-lease", placeOf(std::to_string(pass.job), pass.frame), true);
        }
    }

    void checkUnfinished(const JobRow& job) {
        uint64_t merged = 0;
        uint32_t done = 0;
        for (FrameRow& frame : t.frames.list(job.key)) {
            if (frame.state == FrameState::active) frameCountsMatchRows(job, frame);
            merged += frame.passesMerged;
            done += frame.state == FrameState::completed;
        }
        if (merged == job.passesMerged && done == job.framesDone) return;
        JobRow fixed = job;
        fixed.passesMerged = merged;
        fixed.framesDone = done;
        t.jobs.update(fixed);
        report("job-counts-match-frames", "job " + job.id, true);
    }

    void frameCountsMatchRows(const JobRow& job, FrameRow& frame) {
        const PassCounts rows = t.passes.counts(frame.job, frame.frame);
        const auto info = catalog_.get(t, job);
        // Rows of complete levels are gone; all of theirs were merged.
        uint64_t gone = 0;
        for (const SampleRange& level : info->schedule)
            gone += level.end() <= frame.samplesMerged ? frame.tiles : 0;
        const uint64_t merged = gone + rows.merged;
        if (frame.passesQueued != rows.queued || frame.passesLeased != rows.leased ||
            frame.passesMerged != merged) {
            frame.passesQueued = rows.queued;
            frame.passesLeased = rows.leased;
            frame.passesMerged = merged;
            t.frames.update(frame);
            report("frame-counts-match-passes", placeOf(job.id, frame.frame), true);
        }
        // The tail of every stuck job: nothing queued, nothing leased, nothing left to create.
        if (frame.samplesMerged < info->spec.stop.samples && frame.levelsCreated == frame.levels &&
            rows.queued + rows.leased == 0) {
            report("active-frame-has-work", placeOf(job.id, frame.frame), false);
        }
    }

    void report(std::string invariant, std::string detail, bool repaired) {
        found_.push_back({std::move(invariant), std::move(detail), repaired});
    }

    Tables& t;
    JobCatalog& catalog_;
    TimePoint now_;
    std::vector<Violation> found_;
};

}  // namespace

std::vector<Violation> Scheduler::sweep() {
    expire();
    const std::scoped_lock lock(mutex_);
    std::vector<Violation> found;
    const TimePoint now = clock_.now();
    write([&](Tables& t) {
        found = Sweeper(t, catalog_, now).run();
        // An open lease of the database that nobody watches would never expire.
        for (const LeaseRow& lease : t.leases.open()) {
            if (open_.contains(lease.id)) continue;
            giveUp(t, lease.id, LeaseState::expired);
            found.push_back({"open-lease-is-watched", "lease " + lease.id, true});
        }
        t.leases.forgetClosedBefore(now - kLeasesKept);
        std::erase_if(lost_, [&](const auto& at) { return !t.leases.find(at.first); });
        t.workers.forgetSeenBefore(now - kWorkersKept);
        t.events.forgetBelow(t.events.lastId() - config_.eventsKept);
    });
    roster_.forgetSeenBefore(now - kWorkersKept);
    return found;
}

}  // namespace tilefarm
