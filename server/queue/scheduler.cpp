#include "server/queue/scheduler.h"

#include <nlohmann/json.hpp>

#include "server/queue/event_json.h"
#include "server/store/file.h"
#include "shared/error/error.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

std::vector<WorkerRow> storedWorkers(const JobStore& store) {
    std::vector<WorkerRow> workers;
    store.read([&](const ConstTables& t) { workers = t.workers.list(); });
    return workers;
}

// All of it but the scene's files, of which there may be many.
std::string outlineOf(nlohmann::json spec) {
    auto& scene = spec.at("scene");
    const std::string entry = scene.at("entry");
    scene["files"] = {{entry, scene.at("files").at(entry)}};
    return spec.dump();
}

JobRow newRow(const JobSpec& spec, const nlohmann::json& json, TimePoint now) {
    JobRow row;
    row.id =
        "j" + randomHex(10);  // random, so that another farm's job of the same number is not mistaken for it
    row.outlineJson = outlineOf(json);
    row.priority = spec.priority;
    row.created = now;
    row.frames = spec.frames.count;
    const JobInfo info(0, row.id, spec);
    row.passes = info.passes();
    row.pixelSamples = info.pixelSamplesPerFrame() * spec.frames.count;
    return row;
}

JobRow knownJob(const ConstTables& t, const std::string& id) {
    if (auto job = t.jobs.find(id)) return *job;
    throw Error(ErrorCode::notFound, "there is no job '" + id + "'");
}

}  // namespace

Scheduler::Scheduler(JobStore& store, const Clock& clock, QueueConfig config, std::function<void()> changed)
    : store_(store),
      clock_(clock),
      config_(config),
      changed_(std::move(changed)),
      roster_(config.workerOnlineFor, storedWorkers(store)) {
    // Workers may have renewed while this server was down: every open lease gets a whole one more.
    store_.read([&](const ConstTables& t) {
        for (const LeaseRow& lease : t.leases.open()) {
            const auto frame = t.frames.find(lease.job, lease.frame);
            open_[lease.id] = {.epoch = lease.epoch,
                               .job = lease.job,
                               .worker = lease.worker,
                               .deadline = clock_.now() + config_.leaseTime,
                               .session = lease.session,
                               .frameRevision = frame ? frame->revision : 0};
        }
        for (const LeaseRow& lease : t.leases.lost()) lost_[lease.id] = {lease.job, lease.session};
    });
}

void Scheduler::write(const std::function<void(Tables&)>& work) {
    eventsWritten_ = false;
    store_.write(work);
    if (eventsWritten_ && changed_) changed_();
}

void Scheduler::note(Tables& t, const JobRow& job, std::string type, std::string data) {
    t.events.add({0, job.key, job.id, clock_.now(), std::move(type), std::move(data)});
    eventsWritten_ = true;
}

void Scheduler::noteJobState(Tables& t, const JobRow& job) {
    note(t, job, "job", jobStateJson(job));
}

Submission Scheduler::submit(const JobSpec& spec, const std::string& idempotencyKey,
                             const std::string& bodyDigest) {
    const std::scoped_lock lock(mutex_);
    Submission submission;
    write([&](Tables& t) {
        const auto before =
            idempotencyKey.empty() ? std::nullopt : t.jobs.findByIdempotencyKey(idempotencyKey);
        if (before && before->bodyDigest != bodyDigest) {
            throw Error(ErrorCode::conflict, "the idempotency key was used for another request");
        }
        if (before) {
            submission = {*before, false};
            return;
        }
        const nlohmann::json text = toJson(spec);
        JobRow row = newRow(spec, text, clock_.now());
        row.idempotencyKey = idempotencyKey;
        row.bodyDigest = bodyDigest;
        row.key = t.jobs.insert(row, text.dump());
        noteJobState(t, row);
        submission = {row, true};
    });
    return submission;
}

JobRow Scheduler::moveJob(const std::string& id, const std::function<JobState(const JobRow&)>& target) {
    const std::scoped_lock lock(mutex_);
    JobRow job;
    write([&](Tables& t) {
        job = knownJob(t, id);
        const JobState to = target(job);
        if (job.state == to) return;  // asked twice: the first answer may have been lost
        if (!canMove(job.state, to)) {
            throw Error(ErrorCode::conflict, "job '" + id + "' is " + std::string(toString(job.state)) +
                                                 " and cannot become " + std::string(toString(to)));
        }
        if (isFinal(to)) {
            endJob(t, job, to);
        } else {
            job.state = to;
            if (!job.setAside.empty()) forgive(t, job);
            t.jobs.update(job);
            noteJobState(t, job);
        }
    });
    return job;
}

JobRow Scheduler::cancel(const std::string& id) {
    return moveJob(id, [](const JobRow&) { return JobState::canceled; });
}

JobRow Scheduler::pause(const std::string& id) {
    return moveJob(id, [](const JobRow&) { return JobState::paused; });
}

JobRow Scheduler::resume(const std::string& id) {
    return moveJob(id, [](const JobRow& job) {
        if (job.state != JobState::paused)
            return job.state == JobState::queued ? job.state : JobState::running;
        return job.started ? JobState::running : JobState::queued;
    });
}

// The one way into a final state: nobody works on the job afterwards. Tiles stay, so that what was
// merged of an ended job can still be seen.
void Scheduler::endJob(Tables& t, JobRow& job, JobState state) {
    job.state = state;
    job.finished = clock_.now();
    job.setAside.clear();
    t.jobs.update(job);
    noteJobState(t, job);
    closeLeasesOf(t, job.key);
    t.leases.forgetDeaths(job.key);
    for (FrameRow& frame : t.frames.listActive(job.key)) {
        t.passes.drop(job.key, frame.frame);
        frame.passesQueued = frame.passesLeased = 0;
        t.frames.update(frame);
    }
}

void Scheduler::closeLeasesOf(Tables& t, JobKey job) {
    std::erase_if(open_, [&](const auto& at) {
        if (at.second.job != job) return false;
        t.leases.close(at.second.epoch, LeaseState::revoked);
        return true;
    });
}

std::vector<WorkerRow> Scheduler::workers() const {
    const std::scoped_lock lock(mutex_);
    return roster_.list(clock_.now());
}

double Scheduler::workerRate(const std::string& worker) const {
    const std::scoped_lock lock(mutex_);
    return roster_.lastRate(worker);
}

size_t Scheduler::openLeases() const {
    const std::scoped_lock lock(mutex_);
    return open_.size();
}

}  // namespace tilefarm
