#include <algorithm>
#include <cmath>

#include "server/queue/event_json.h"
#include "server/queue/scheduler.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

void requireWanted(const JobRow& job) {
    if (job.state == JobState::canceled) throw Error(ErrorCode::gone, "job '" + job.id + "' was canceled");
    if (job.state == JobState::failed) throw Error(ErrorCode::conflict, "job '" + job.id + "' has failed");
}

uint64_t samplesOf(const JobInfo& job, uint32_t tile, uint32_t first) {
    return job.grid.rect(tile).area() * job.level(first)->count;
}

void addFaults(JobRow& job, const FrameRow& frame, const PassFaults& faults) {
    job.rejectedPaths += faults.rejectedPaths;
    job.truncatedPaths += faults.truncatedPaths;
    job.truncatedThroughput += faults.truncatedThroughput;
    job.clampedSamples += faults.clampedSamples;
    job.clampedLuminance += faults.clampedLuminance;
    job.lightsBehindGlass += faults.lightsBehindGlass;
    for (const DroppedSample& s : faults.dropped)
        if (job.faultSamples.size() < kMostDropped)
            job.faultSamples.push_back(std::to_string(frame.frame) + ' ' + std::to_string(s.x) + ' ' +
                                       std::to_string(s.y) + ' ' + std::to_string(s.sample));
}

}  // namespace

// What an upload newly brought in.
struct Scheduler::Tally {
    const JobInfo& job;
    uint32_t merged = 0;
    uint32_t alreadyMerged = 0;
    uint64_t samples = 0;
};

ResultTarget Scheduler::resultTarget(const std::string& leaseId, uint64_t epoch) {
    ResultTarget target;
    store_.read([&](const ConstTables& t) {
        const auto lease = t.leases.find(leaseId);
        if (!lease) throw Error(ErrorCode::notFound, "there is no lease '" + leaseId + "'");
        if (lease->epoch != epoch)
            throw Error(ErrorCode::conflict, "lease '" + leaseId + "' has a different epoch");
        const JobRow job = *t.jobs.find(lease->job);
        requireWanted(job);
        target = {*lease, catalog_.get(t, job)};
    });
    return target;
}

// Durable already: the film slots and files that `merge` names. Here one transaction makes them count,
// so a crash before it leaves the old slots in force, and a crash after it loses nothing.
ResultReceipt Scheduler::commit(const ResultTarget& target, const ResultMerge& merge) {
    const std::scoped_lock lock(mutex_);
    heardOfLease(target.lease.id);
    Tally tally{*target.job, 0, merge.alreadyMerged, 0};
    double seconds = 0;
    write([&](Tables& t) {
        JobRow job = *t.jobs.find(target.lease.job);
        requireWanted(job);
        FrameRow frame = *t.frames.find(job.key, target.lease.frame);
        for (const TileMerge& tile : merge.tiles) commitTile(t, frame, tile, tally);

        // Seconds of an upload that brings only part of what it holds count in proportion.
        seconds = merge.uploadedSamples == 0 ? 0
                                             : merge.deviceSeconds * static_cast<double>(tally.samples) /
                                                   static_cast<double>(merge.uploadedSamples);
        const double before = frame.deviceSeconds;
        frame.deviceSeconds += seconds;
        job.deviceSeconds += seconds;
        job.passesMerged += tally.merged;
        job.pixelSamplesMerged += tally.samples;
        frame.passesMerged += tally.merged;
        addFaults(job, frame, merge.faults);
        job.keptLuminance += merge.keptLuminance;
        if (tally.merged > 0) {
            ++frame.revision;
            if (job.suspectFrame == frame.frame) job.suspectFrame.reset();
            t.workers.addContribution({job.key, target.lease.worker, seconds, tally.merged, tally.samples});
        }
        completeLevels(t, job, frame, *target.job, merge, before);
        if (tally.merged > 0 && atFixedPoint(frame, *target.job)) decideNext(t, job, frame, *target.job);
        t.frames.update(frame);
        t.jobs.update(job);
        if (tally.merged > 0) note(t, job, "progress", progressJson(job, frame));
        if (target.lease.state == LeaseState::open && open_.contains(target.lease.id)) {
            giveUp(t, target.lease.id, LeaseState::merged);
        }
    });
    open_.erase(target.lease.id);
    roster_.seen(target.lease.worker, clock_.now());
    roster_.measured(target.lease.worker, target.lease.job, static_cast<double>(tally.samples), seconds);
    return {tally.merged, tally.alreadyMerged};
}

void Scheduler::commitTile(Tables& t, FrameRow& frame, const TileMerge& tile, Tally& tally) {
    const auto current = t.frames.tile(frame.job, frame.frame, tile.before.tile);
    if (!current || *current != tile.before) {
        throw Error(ErrorCode::conflict, "the tile was changed by another result meanwhile");
    }
    if (tile.after != tile.before) t.frames.update(tile.after);
    if (tally.job.spec.stop.decidesOnTheWay()) measureTile(t, frame, tile);
    const auto pass = [&](uint32_t first) {
        return *t.passes.find(frame.job, frame.frame, tile.before.tile, first);
    };
    for (const uint32_t first : tile.merged) commitPass(t, frame, pass(first), tally);
    for (const PassRow& held : tile.held) {
        PassRow row = pass(held.samples.first);
        row.held = held.held;
        commitPass(t, frame, row, tally);
    }
    for (const uint32_t first : tile.unheld) {
        PassRow row = pass(first);
        row.held.reset();
        t.passes.update(row);
    }
}

void Scheduler::commitPass(Tables& t, FrameRow& frame, PassRow pass, Tally& tally) {
    if (pass.state == PassState::queued) --frame.passesQueued;
    if (pass.state == PassState::leased) --frame.passesLeased;
    pass.state = PassState::merged;
    t.passes.update(pass);
    ++tally.merged;
    tally.samples += samplesOf(tally.job, pass.tile, pass.samples.first);
}

// Of the level that was the last complete one.
void Scheduler::dropTail(Tables& t, const FrameRow& frame) {
    auto level = t.frames.level(frame.job, frame.frame, frame.samplesMerged);
    if (!level) return;
    level->errorTail = {};
    t.frames.put(*level);
}

// The level becomes a point of the error curve, and what the frame has reached.
void Scheduler::completeLevel(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info, LevelRow& level) {
    const double pixels = static_cast<double>(info.spec.image.width) * info.spec.image.height;
    if (level.samples > 1) level.relativeError = std::sqrt(level.relativeVariance / pixels);
    job.droppedSamples += level.droppedSamples - std::min(level.droppedSamples, frame.droppedSamples);
    frame.droppedSamples = std::max(frame.droppedSamples, level.droppedSamples);
    dropTail(t, frame);
    frame.samplesMerged = job.samplesMerged = level.samples;
    frame.relativeError = job.relativeError = level.relativeError;
}

// Adds the tiles' measurements to their levels, of those levels that all tiles take. A level that all tiles
// have reached becomes a point of the error curve; of this upload's seconds it is charged the share of
// samples up to that level, or a lease over several levels would put them all at one time.
void Scheduler::completeLevels(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info,
                               const ResultMerge& merge, double secondsBefore) {
    std::map<uint32_t, LevelRow> sums;
    for (const TileMerge& tile : merge.tiles) {
        for (const LevelRow& part : tile.levels) {
            if (part.samples > info.schedule[info.freeLevels - 1].end()) continue;
            LevelRow& sum = sums[part.samples];
            ++sum.tiles;
            sum.addSums(part);
        }
    }
    const double seconds = frame.deviceSeconds - secondsBefore;
    const uint32_t samplesBefore = frame.samplesMerged;
    double total = 0, soFar = 0;
    const auto weight = [&](const LevelRow& sum) {
        return static_cast<double>(sum.tiles) * info.levelEnding(sum.samples)->count;
    };
    for (auto& [samples, sum] : sums) {
        sum.samples = samples;
        total += weight(sum);
    }
    for (const auto& [samples, sum] : sums) {
        soFar += weight(sum);
        LevelRow level = t.frames.level(frame.job, frame.frame, samples)
                             .value_or(LevelRow{.job = frame.job,
                                                .frame = frame.frame,
                                                .samples = samples,
                                                .relativeError = {},
                                                .deviceSeconds = {}});
        level.tiles += sum.tiles;
        level.addSums(sum);
        if (level.tiles == frame.tiles) {
            level.deviceSeconds = secondsBefore + seconds * soFar / total;
            completeLevel(t, job, frame, info, level);
            t.passes.drop(frame.job, frame.frame, samples);
        }
        t.frames.put(level);
    }
    if (frame.samplesMerged > samplesBefore) keepForecast(t, frame, info);
    if (frame.samplesMerged == info.spec.stop.samples && frame.state == FrameState::active &&
        !info.spec.stop.decidesOnTheWay())
        finishFrame(t, job, frame, StopReason::samples);
}

void Scheduler::frameWritten(JobKey key, int32_t number, const std::string& exrSha256, uint64_t exrBytes) {
    const std::scoped_lock lock(mutex_);
    write([&](Tables& t) {
        FrameRow frame = *t.frames.find(key, number);
        if (frame.state != FrameState::finishing) return;
        JobRow job = *t.jobs.find(key);
        frame.state = FrameState::completed;
        frame.exrSha256 = exrSha256;
        frame.exrBytes = exrBytes;
        t.frames.update(frame);
        t.frames.dropTiles(key, number);
        // Of a single frame, such as a pilot's, what the tiles measured stays for forecasts.
        if (job.frames > 1) t.frames.dropTileErrors(key, number);
        t.passes.drop(key, number);
        note(t, job, "frame", frameStateJson(frame));
        ++job.framesDone;
        if (job.framesDone == job.frames && canMove(job.state, JobState::completed)) {
            endJob(t, job, JobState::completed);
        } else {
            t.jobs.update(job);
        }
    });
}

}  // namespace tilefarm
