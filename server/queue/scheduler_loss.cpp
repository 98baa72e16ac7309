// Workers that end while they hold passes, and jobs that end their workers.
//
// A lease is lost when it runs out, or when a later process on the machine says that its own was killed. Each
// loss counts as a death for every pass of the lease, until the process is heard from again: a slow worker,
// an outage and a restart of this server all end with a call of the same process, and then nothing was
// counted. A process that held passes of several jobs may have been ended by any of them; that counts for
// none.
//
// From then on the job is tried with care:
//   - not on a machine where it ended a worker, as long as there are others;
//   - while nothing of the frame was merged since and a worker is missed, by one worker at a time, which
//     holds nothing else (so the next death is surely the job's), and of that frame alone;
//   - a pass that several workers held when they ended sets the job aside, until a person resumes it.
// Other jobs are handed out meanwhile.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "server/queue/event_json.h"
#include "server/queue/scheduler.h"

namespace tilefarm {

Scheduler::Turn Scheduler::turnOf(const JobRow& job, const WorkerHello& hello) const {
    const auto& died = job.diedOn;
    if (std::find(died.begin(), died.end(), machineOf(hello)) != died.end() &&
        roster_.onlineElsewhere(died, clock_.now()))
        return Turn::later;
    if (!job.suspectFrame) return Turn::now;
    const auto anyOpen = [&](const auto& matches) {
        return std::any_of(open_.begin(), open_.end(), [&](const auto& at) { return matches(at.second); });
    };
    if (anyOpen([&](const OpenLease& lease) { return lease.job == job.key; })) return Turn::later;
    // It asked for more while it uploads: it will have nothing else in a moment.
    const std::string session = sessionOf(hello);
    return anyOpen([&](const OpenLease& lease) { return lease.session == session; }) ? Turn::wait : Turn::now;
}

bool Scheduler::inTrial(const std::string& session) const {
    return std::any_of(open_.begin(), open_.end(),
                       [&](const auto& at) { return at.second.alone && at.second.session == session; });
}

void Scheduler::loseLeases(const std::function<bool(const OpenLease&)>& isLost) {
    std::map<std::string, Loss> losses;
    for (const auto& [id, lease] : open_) {
        if (isLost(lease)) losses.emplace(id, Loss::none);
    }
    if (losses.empty()) return;
    write([&](Tables& t) {
        for (auto& [id, loss] : losses) loss = lose(t, id);
    });
    for (const auto& [id, loss] : losses) {
        const auto lease = open_.extract(id);
        if (!lease.empty() && loss != Loss::none) lost_[id] = {lease.mapped().job, lease.mapped().session};
    }
}

Loss Scheduler::lose(Tables& t, const std::string& leaseId) {
    const OpenLease& open = open_.at(leaseId);
    const auto lease = t.leases.find(leaseId);
    const uint64_t released = giveUp(t, leaseId, LeaseState::expired);
    auto job = t.jobs.find(open.job);
    if (job) note(t, *job, "lease", leaseJson(open.worker, LeaseState::expired));
    if (!job || !lease || released == 0) return Loss::none;

    const FrameRow frame = *t.frames.find(lease->job, lease->frame);
    if (frame.revision == open.frameRevision) job->suspectFrame = lease->frame;
    const Loss loss = heldOneJobOnly(open.session) ? Loss::counted : Loss::shared;
    t.leases.setLoss(lease->epoch, loss);
    if (loss == Loss::counted) {
        t.leases.addDeaths(*lease, 1);
        if (std::find(job->diedOn.begin(), job->diedOn.end(), lease->machine) == job->diedOn.end())
            job->diedOn.push_back(lease->machine);
        setAsideIfDeadly(t, *job);
    }
    t.jobs.update(*job);
    return loss;
}

// Of all that the process holds, or held when it was last heard from.
bool Scheduler::heldOneJobOnly(const std::string& session) const {
    std::set<JobKey> jobs;
    for (const auto& [id, lease] : open_)
        if (lease.session == session) jobs.insert(lease.job);
    for (const auto& [id, lease] : lost_)
        if (lease.session == session) jobs.insert(lease.job);
    return jobs.size() == 1;
}

// Processes that are known to have ended: nobody will speak for their leases any more.
void Scheduler::bury(const std::vector<std::string>& sessions) {
    if (sessions.empty()) return;
    const auto ended = [&](const auto& lease) {
        return std::find(sessions.begin(), sessions.end(), lease.session) != sessions.end();
    };
    loseLeases(ended);
    std::erase_if(lost_, [&](const auto& at) { return ended(at.second); });
}

void Scheduler::heardOfLease(const std::string& leaseId) {
    if (const auto at = lost_.find(leaseId); at != lost_.end()) heard(std::string(at->second.session));
}

void Scheduler::heard(const std::string& session) {
    std::vector<std::string> found;
    for (const auto& [id, lease] : lost_)
        if (lease.session == session) found.push_back(id);
    if (found.empty()) return;
    write([&](Tables& t) {
        for (const std::string& id : found) takeBackDeath(t, id);
    });
    for (const std::string& id : found) lost_.erase(id);
}

void Scheduler::takeBackDeath(Tables& t, const std::string& leaseId) {
    const auto lease = t.leases.find(leaseId);
    auto job = lease ? t.jobs.find(lease->job) : std::nullopt;
    if (!job) return;
    t.leases.setLoss(lease->epoch, Loss::none);
    if (isFinal(job->state)) return;
    if (lease->loss == Loss::counted) {
        t.leases.addDeaths(*lease, -1);
        std::erase(job->diedOn, lease->machine);
    }
    const bool othersMissed = std::any_of(lost_.begin(), lost_.end(), [&](const auto& at) {
        return at.second.job == job->key && at.second.session != lease->session;
    });
    if (!othersMissed && !t.leases.deadly(job->key, 1)) job->suspectFrame.reset();
    if (!job->setAside.empty() && !deadlyPassOf(t, *job)) {
        job->setAside.clear();
        job->state = JobState::running;
        noteJobState(t, *job);
    }
    t.jobs.update(*job);
}

std::optional<DeadlyPass> Scheduler::deadlyPassOf(Tables& t, const JobRow& job) const {
    if (config_.deathsThatSetAside == 0) return std::nullopt;
    return t.leases.deadly(job.key, config_.deathsThatSetAside);
}

// One that a person has paused stays theirs, and is looked at when a worker dies of it again.
void Scheduler::setAsideIfDeadly(Tables& t, JobRow& job) {
    const auto pass = deadlyPassOf(t, job);
    if (!pass || job.state != JobState::running) return;
    job.setAside = fmt::format(
        "set aside: {} workers were killed, crashed or vanished while they held frame {}, tile {}, samples "
        "from {} (on {}); the scene may need more memory than they have. Resume the job to try again",
        pass->deaths, pass->frame, pass->tile, pass->firstSample, fmt::join(job.diedOn, ", "));
    job.state = JobState::paused;
    noteJobState(t, job);
}

// A person has looked: all counts from the beginning.
void Scheduler::forgive(Tables& t, JobRow& job) {
    t.leases.forgetDeaths(job.key);
    job.setAside.clear();
    job.diedOn.clear();
}

}  // namespace tilefarm
