#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/clock/clock.h"
#include "shared/film/error_tail.h"
#include "shared/film/sample_plan.h"
#include "shared/job/leased_pass.h"
#include "shared/job/states.h"
#include "shared/job/worker_hello.h"

namespace tilefarm {

/// The rows of the database as plain values. Counts live in the job and frame rows, so that a list
/// costs as much as the page it shows.

using JobKey = int64_t;  // grows with every job; `JobRow::id` is what the API shows

struct JobRow {
    JobKey key = 0;
    std::string id;
    JobState state = JobState::queued;
    int32_t priority = 50;
    std::string outlineJson;     // what was submitted, without its scene's files but for the entry
    std::string idempotencyKey;  // empty: none
    std::string bodyDigest;      // of the request that made it
    TimePoint created{};
    std::optional<TimePoint> started, finished;
    uint64_t passes = 0;        // of all frames, as far as can be foreseen
    uint64_t passesMerged = 0;  // accepted and durable
    uint64_t passesQueued = 0;  // sums over its frames; the store keeps them, an update passes them over
    uint64_t passesLeased = 0;
    uint64_t pixelSamples = 0;  // the same as work: passes differ much in samples
    uint64_t pixelSamplesMerged = 0;
    uint32_t frames = 0;
    uint32_t framesStarted = 0;  // frame rows exist for the first so many frames
    uint32_t framesDone = 0;
    uint32_t samplesMerged = 0;  // of the last frame that completed a pass level
    std::optional<double> relativeError;
    double deviceSeconds = 0;
    uint64_t droppedSamples = 0;
    std::vector<std::string> faults;
    // PassFaults of shared/film/film.h, of all merged passes.
    uint64_t rejectedPaths = 0, truncatedPaths = 0, clampedSamples = 0, lightsBehindGlass = 0;
    double truncatedThroughput = 0, clampedLuminance = 0;
    double keptLuminance = 0;               // of all samples, summed up; counted where settings clamp
    std::vector<std::string> faultSamples;  // "frame x y sample" of the first dropped samples
    // What is known of workers that ended while they held passes: server/queue/scheduler_loss.cpp.
    std::optional<int32_t> suspectFrame;  // tried by one worker at a time until some of it is merged
    std::vector<std::string> diedOn;      // machines where a worker ended with passes of this job alone
    std::string setAside;                 // why no more is handed out until a person resumes it; empty: it is

    double fractionDone() const {
        return pixelSamples == 0
                   ? 0
                   : static_cast<double>(pixelSamplesMerged) / static_cast<double>(pixelSamples);
    }
};

/// active: passes are handed out; finishing: all merged, the image is being written.
enum class FrameState { active, finishing, completed };

struct FrameRow {
    JobKey job = 0;
    int32_t frame = 0;
    FrameState state = FrameState::active;
    uint32_t levels = 0;         // passes of the schedule
    uint32_t levelsCreated = 0;  // passes of the first so many levels have rows (or had, until merged)
    uint32_t tiles = 0;
    uint64_t passesMerged = 0;
    uint64_t passesQueued = 0;  // rows in each state
    uint64_t passesLeased = 0;
    uint32_t samplesMerged = 0;  // of every pixel; the mean where tiles differ
    std::optional<double> relativeError;
    double deviceSeconds = 0;
    uint64_t droppedSamples = 0;
    uint64_t revision = 0;  // grows with every merge: names a state of the picture
    std::string exrSha256;  // once completed
    uint64_t exrBytes = 0;
    std::optional<TimePoint> started{};
    std::optional<StopReason> stopReason{};  // once all is merged
    uint64_t passes = 0, pixelSamples = 0;   // in all, as far as can be foreseen
    // Device seconds that the frame was expected to take, with their interval, told once it had taken forecastAt.
    std::optional<double> forecastAt{}, forecastSeconds{}, forecastLow{}, forecastHigh{};
};

/// Work of frames, as far as can be foreseen.
struct FrameWork {
    uint64_t passes = 0, pixelSamples = 0;
    friend bool operator==(const FrameWork&, const FrameWork&) = default;
};

struct TileRow {
    JobKey job = 0;
    int32_t frame = 0;
    uint32_t tile = 0;
    uint32_t slot = 0;           // which of the two film slots is valid
    uint32_t mergedSamples = 0;  // passes covering [0, mergedSamples) are in the film
    friend bool operator==(const TileRow&, const TileRow&) = default;
};

/// A pass level of a frame: what its tiles measured with samples [0, samples) merged. Complete, and a
/// point of the error curve, once every tile has reached it.
struct LevelRow {
    JobKey job = 0;
    int32_t frame = 0;
    uint32_t samples = 0;
    uint32_t tiles = 0;  // that have reached it
    // Sums over their pixels, as in ErrorSums: relativeVariance, squares and borrowed.
    double relativeVariance = 0, errorSquares = 0, borrowedVariance = 0;
    ErrorTail errorTail{};  // likewise; kept for the last complete level alone
    uint64_t droppedSamples = 0;
    std::optional<double> relativeError;  // once complete; unknown at one sample
    std::optional<double> deviceSeconds;  // of the frame so far, once complete
    /// Adds what further tiles measured.
    void addSums(const LevelRow& other);
    friend bool operator==(const LevelRow&, const LevelRow&) = default;
};

/// What a tile measures with all that is merged of it, in jobs that decide by it which tiles go on. `pixels`
/// of its error is not kept: the job says it.
struct TileErrorRow {
    JobKey job = 0;
    int32_t frame = 0;
    uint32_t tile = 0;
    TileError error{};
    // Sums over its pixels, as in LevelRow.
    double errorSquares = 0, borrowedVariance = 0;
    ErrorTail errorTail{};
    uint64_t droppedSamples = 0;
    friend bool operator==(const TileErrorRow&, const TileErrorRow&) = default;
};

/// A durable pass that waits for its predecessors: where its pixels lie.
struct HeldPass {
    std::string file;
    uint64_t offset = 0;
};

struct PassRow {
    JobKey job = 0;
    int32_t frame = 0;
    uint32_t tile = 0;
    SampleRange samples;
    PassState state = PassState::queued;
    uint64_t epoch = 0;  // of the last lease; 0: never leased
    std::optional<HeldPass> held;
    TimePoint queuedAt{};
};

/// Whether a lease was lost with its process: it ran out, or the process is known to have ended.
/// counted: as a death, for each of its passes; shared: the process held other jobs' passes as well, so
/// that nobody knows which of them ended it.
enum class Loss { none, counted, shared };

enum class LeaseState { open, merged, expired, returned, failed, revoked };

struct LeaseRow {
    uint64_t epoch = 0;  // grows with every grant
    std::string id;
    std::string worker;
    JobKey job = 0;
    int32_t frame = 0;
    LeaseState state = LeaseState::open;
    TimePoint granted{};
    std::vector<LeasedPass> passes;
    std::string session{};  // the worker's process
    std::string machine{};  // where it runs
    Loss loss = Loss::none;
};

/// A pass that workers held when they ended.
struct DeadlyPass {
    int32_t frame = 0;
    uint32_t tile = 0, firstSample = 0;
    uint64_t deaths = 0;
    friend bool operator==(const DeadlyPass&, const DeadlyPass&) = default;
};

enum class WorkerState { online, draining, parked, quarantined, offline };

struct WorkerRow {
    WorkerHello hello;
    WorkerState state = WorkerState::online;
    std::string reason;  // why quarantined or parked
    TimePoint firstSeen{}, lastSeen{};
};

/// What a worker gave to a job.
struct ContributionRow {
    JobKey job = 0;
    std::string worker;
    double deviceSeconds = 0;
    uint64_t passes = 0;
    uint64_t samples = 0;  // pixel samples
};

struct FailureRow {
    JobKey job = 0;
    int32_t frame = 0;
    uint32_t tile = 0;
    uint32_t firstSample = 0;
    std::string worker;
    std::string message;
    uint32_t reports = 1;
};

struct ReportRow {
    JobKey job = 0;
    std::string worker;
    std::string json;
};

struct EventRow {
    int64_t id = 0;
    JobKey job = 0;  // 0: of no job
    std::string jobId;
    TimePoint at{};
    std::string type;
    std::string json;
};

/// Why all of the frame is merged, for people; empty while it is not.
std::string stopSentence(const FrameRow& frame, const StopCondition& stop);

/// Of the four only `running` is left for another.
enum class StudyState { running, completed, failed, canceled };

struct StudyRow {
    int64_t key = 0;  // grows with every study; `id` is what the API shows
    std::string id;
    StudyState state = StudyState::running;
    std::string requestJson;  // canonical
    TimePoint created{};
    std::optional<TimePoint> finished;  // nothing is left to do for it, its jobs included
    std::string fault;                  // why it failed
};

/// A variant at a number of samples, once its jobs are complete and their pictures compared.
struct StudyCellRow {
    int64_t study = 0;
    uint32_t cell = 0;
    std::string resultJson;
    std::string picturesJson;  // apart, for they are large
};

std::string_view toString(FrameState state);
std::string_view toString(LeaseState state);
std::string_view toString(Loss loss);
std::string_view toString(WorkerState state);
std::string_view toString(StudyState state);
FrameState frameStateFrom(std::string_view word);
LeaseState leaseStateFrom(std::string_view word);
Loss lossFrom(std::string_view word);
WorkerState workerStateFrom(std::string_view word);
StudyState studyStateFrom(std::string_view word);

}  // namespace tilefarm
