// Jobs that decide on the way which tiles of a frame get further samples, and when it is complete.
//
// Every tile gets the free levels of the schedule. From then on a frame comes to a fixed point whenever none
// of its passes is out: what is merged there follows from the job alone, whoever rendered it and in whatever
// order it arrived. `decide` (shared/film/sample_plan.h) says what comes next, in the transaction that merged
// the last pass: a server that is killed has either not come to the fixed point or has decided.
#include "server/queue/event_json.h"
#include "server/queue/scheduler.h"
#include "server/report/forecasts.h"

namespace tilefarm {
namespace {

constexpr double kShareBeforeForecast = 0.1;     // of what a frame is expected to take
constexpr uint32_t kSamplesBeforeForecast = 16;  // fewer say little of the error

// In the order of tiles: sums of doubles depend on it.
LevelRow levelOf(const FrameRow& frame, const std::vector<TileErrorRow>& tiles) {
    LevelRow sum{.job = frame.job, .frame = frame.frame, .relativeError = {}, .deviceSeconds = {}};
    for (const TileErrorRow& tile : tiles) {
        ++sum.tiles;
        sum.addSums({.relativeVariance = tile.error.variance,
                     .errorSquares = tile.errorSquares,
                     .borrowedVariance = tile.borrowedVariance,
                     .errorTail = tile.errorTail,
                     .droppedSamples = tile.droppedSamples,
                     .relativeError = {},
                     .deviceSeconds = {}});
    }
    return sum;
}

}  // namespace

void Scheduler::measureTile(Tables& t, const FrameRow& frame, const TileMerge& tile) {
    if (tile.levels.empty()) return;
    const uint32_t index = tile.before.tile;
    TileErrorRow row = t.frames.tileError(frame.job, frame.frame, index)
                           .value_or(TileErrorRow{.job = frame.job, .frame = frame.frame, .tile = index});
    for (const LevelRow& level : tile.levels) row.error.reach(level.samples, level.relativeVariance);
    const LevelRow& last = tile.levels.back();
    row.errorSquares = last.errorSquares;
    row.borrowedVariance = last.borrowedVariance;
    row.errorTail = last.errorTail;
    row.droppedSamples = last.droppedSamples;
    t.frames.put(row);
}

bool Scheduler::atFixedPoint(const FrameRow& frame, const JobInfo& info) {
    return info.spec.stop.decidesOnTheWay() && frame.state == FrameState::active &&
           frame.levelsCreated == frame.levels && frame.passesQueued + frame.passesLeased == 0;
}

void Scheduler::decideNext(Tables& t, JobRow& job, FrameRow& frame, const JobInfo& info) {
    std::vector<TileErrorRow> rows = t.frames.tileErrors(frame.job, frame.frame);
    std::vector<TileError> tiles;
    for (TileErrorRow& row : rows) {
        row.error.pixels = info.grid.rect(row.tile).area();
        tiles.push_back(row.error);
    }
    LevelRow level = levelOf(frame, rows);
    level.samples = meanSamples(tiles);
    level.deviceSeconds = frame.deviceSeconds;
    completeLevel(t, job, frame, info, level);
    t.frames.put(level);
    keepForecast(t, frame, info);

    const double wallSeconds =
        std::chrono::duration<double>(clock_.now() - frame.started.value_or(clock_.now())).count();
    const SampleDecision next =
        decide(info.spec.stop, info.schedule, tiles, {frame.deviceSeconds, wallSeconds});
    expectWork(t, job, frame, next);
    if (next.stop)
        finishFrame(t, job, frame, *next.stop);
    else
        promote(t, frame, info, rows, next.tiles);
}

// Once, when enough is spent to tell and enough is left for it to matter.
void Scheduler::keepForecast(const Tables& t, FrameRow& frame, const JobInfo& info) {
    if (frame.forecastAt || frame.state != FrameState::active || frame.samplesMerged < kSamplesBeforeForecast)
        return;
    const auto outlook = outlookOf(t, frame, info.spec);
    if (!outlook) return;
    const Forecast f = forecastOf(*outlook, info.spec.stop);
    if (outlook->deviceSeconds < kShareBeforeForecast * f.deviceSeconds) return;
    frame.forecastAt = outlook->deviceSeconds;
    frame.forecastSeconds = f.deviceSeconds;
    frame.forecastLow = f.low;
    frame.forecastHigh = f.high;
}

// What there is to hand out before all have brought theirs; 0 where nothing waits for that.
uint64_t Scheduler::passesBeforeFixedPoints(const JobInfo& info, const std::vector<FrameRow>& frames) {
    uint64_t passes = 0;
    if (!info.spec.stop.decidesOnTheWay()) return passes;
    for (const FrameRow& frame : frames) {
        passes += frame.passesQueued;
        if (frame.levelsCreated < info.freeLevels)
            passes += uint64_t{frame.tiles} * (info.freeLevels - frame.levelsCreated);
    }
    return passes;
}

// What the job's rows expect of each frame that has not begun.
FrameWork Scheduler::workOfNext(const Tables& t, const JobRow& job, const JobInfo& info) {
    if (!info.spec.stop.decidesOnTheWay()) return {info.passesPerFrame(), info.pixelSamplesPerFrame()};
    const FrameWork begun = t.frames.work(job.key);
    const uint64_t others = job.frames - job.framesStarted;
    return {(job.passes - begun.passes) / others, (job.pixelSamples - begun.pixelSamples) / others};
}

// Frames that have not begun are expected to need as much as this one.
void Scheduler::expectWork(Tables& t, JobRow& job, FrameRow& frame, const SampleDecision& next) {
    frame.passes = next.passes;
    frame.pixelSamples = next.pixelSamples;
    t.frames.update(frame);
    const FrameWork begun = t.frames.work(job.key);
    const uint64_t others = job.frames - job.framesStarted;
    job.passes = begun.passes + others * frame.passes;
    job.pixelSamples = begun.pixelSamples + others * frame.pixelSamples;
}

void Scheduler::promote(Tables& t, FrameRow& frame, const JobInfo& info, std::vector<TileErrorRow>& rows,
                        const std::vector<uint32_t>& tiles) {
    t.passes.drop(frame.job, frame.frame);  // all of them are merged
    std::vector<LeasedPass> passes;
    auto chosen = tiles.begin();
    for (TileErrorRow& row : rows) {
        if (chosen != tiles.end() && *chosen == row.tile) {
            passes.push_back({row.tile, *nextPass(info.schedule, row.error.samples)});
            ++chosen;
        } else if (row.error.earlier != row.error.variance) {
            row.error.rest();
            t.frames.put(row);
        }
    }
    t.passes.insert(frame.job, frame.frame, passes, clock_.now());
    frame.passesQueued = passes.size();
}

void Scheduler::finishFrame(Tables& t, const JobRow& job, FrameRow& frame, StopReason reason) {
    frame.state = FrameState::finishing;
    frame.stopReason = reason;
    note(t, job, "frame", frameStateJson(frame));
}

}  // namespace tilefarm
