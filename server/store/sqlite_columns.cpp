#include "server/store/sqlite_columns.h"

#include <array>

namespace tilefarm {
namespace {

template <typename Class, typename Member>
Class classOf(Member Class::*);

template <typename Row>
auto& follow(Row& row) {
    return row;
}
template <auto first, auto... rest, typename Row>
auto& follow(Row& row) {
    return follow<rest...>(row.*first);
}

// The member at the end of `first` and `rest`, which are pointers to members.
template <auto first, auto... rest>
constexpr auto column(const char* name) {
    using Row = decltype(classOf(first));
    return Column<Row>{
        name, [](const SQLite::Column& from, Row& to) { readValue(from, follow<first, rest...>(to)); },
        [](const Row& from, SQLite::Statement& to, int parameter) {
            bindValue(to, parameter, follow<first, rest...>(from));
        }};
}

// UNIQUE, so that "none" has to be NULL.
constexpr Column<JobRow> kIdempotencyKey{
    "idempotency_key", [](const SQLite::Column& from, JobRow& to) { readValue(from, to.idempotencyKey); },
    [](const JobRow& from, SQLite::Statement& to, int parameter) {
        from.idempotencyKey.empty() ? to.bind(parameter) : bindValue(to, parameter, from.idempotencyKey);
    }};

// HeldPass is there where its columns are.
template <auto member>
constexpr Column<PassRow> heldColumn(const char* name) {
    return {name,
            [](const SQLite::Column& from, PassRow& to) {
                if (from.isNull()) return;
                if (!to.held) to.held.emplace();
                readValue(from, *to.held.*member);
            },
            [](const PassRow& from, SQLite::Statement& to, int parameter) {
                from.held ? bindValue(to, parameter, *from.held.*member) : to.bind(parameter);
            }};
}

constexpr std::array kJobs{column<&JobRow::key>("key"),
                           column<&JobRow::id>("id"),
                           column<&JobRow::state>("state"),
                           column<&JobRow::priority>("priority"),
                           column<&JobRow::outlineJson>("outline"),
                           kIdempotencyKey,
                           column<&JobRow::bodyDigest>("body_digest"),
                           column<&JobRow::created>("created"),
                           column<&JobRow::started>("started"),
                           column<&JobRow::finished>("finished"),
                           column<&JobRow::passes>("passes"),
                           column<&JobRow::passesMerged>("passes_merged"),
                           column<&JobRow::passesQueued>("passes_queued"),
                           column<&JobRow::passesLeased>("passes_leased"),
                           column<&JobRow::pixelSamples>("pixel_samples"),
                           column<&JobRow::pixelSamplesMerged>("pixel_samples_merged"),
                           column<&JobRow::frames>("frames"),
                           column<&JobRow::framesStarted>("frames_started"),
                           column<&JobRow::framesDone>("frames_done"),
                           column<&JobRow::samplesMerged>("samples_merged"),
                           column<&JobRow::relativeError>("relative_error"),
                           column<&JobRow::deviceSeconds>("device_seconds"),
                           column<&JobRow::droppedSamples>("dropped_samples"),
                           column<&JobRow::faults>("faults"),
                           column<&JobRow::rejectedPaths>("rejected_paths"),
                           column<&JobRow::truncatedPaths>("truncated_paths"),
                           column<&JobRow::faultSamples>("fault_samples"),
                           column<&JobRow::truncatedThroughput>("truncated_throughput"),
                           column<&JobRow::clampedSamples>("clamped_samples"),
                           column<&JobRow::clampedLuminance>("clamped_luminance"),
                           column<&JobRow::keptLuminance>("kept_luminance"),
                           column<&JobRow::suspectFrame>("suspect_frame"),
                           column<&JobRow::diedOn>("died_on"),
                           column<&JobRow::setAside>("set_aside"),
                           column<&JobRow::lightsBehindGlass>("lights_behind_glass")};

constexpr std::array kFrames{column<&FrameRow::job>("job"),
                             column<&FrameRow::frame>("frame"),
                             column<&FrameRow::state>("state"),
                             column<&FrameRow::levels>("levels"),
                             column<&FrameRow::levelsCreated>("levels_created"),
                             column<&FrameRow::tiles>("tiles"),
                             column<&FrameRow::passesMerged>("passes_merged"),
                             column<&FrameRow::passesQueued>("passes_queued"),
                             column<&FrameRow::passesLeased>("passes_leased"),
                             column<&FrameRow::samplesMerged>("samples_merged"),
                             column<&FrameRow::relativeError>("relative_error"),
                             column<&FrameRow::deviceSeconds>("device_seconds"),
                             column<&FrameRow::droppedSamples>("dropped_samples"),
                             column<&FrameRow::revision>("revision"),
                             column<&FrameRow::exrSha256>("exr_sha256"),
                             column<&FrameRow::exrBytes>("exr_bytes"),
                             column<&FrameRow::started>("started"),
                             column<&FrameRow::stopReason>("stop_reason"),
                             column<&FrameRow::passes>("passes"),
                             column<&FrameRow::pixelSamples>("pixel_samples"),
                             column<&FrameRow::forecastAt>("forecast_at"),
                             column<&FrameRow::forecastSeconds>("forecast_seconds"),
                             column<&FrameRow::forecastLow>("forecast_low"),
                             column<&FrameRow::forecastHigh>("forecast_high")};

constexpr std::array kTiles{column<&TileRow::job>("job"), column<&TileRow::frame>("frame"),
                            column<&TileRow::tile>("tile"), column<&TileRow::slot>("slot"),
                            column<&TileRow::mergedSamples>("merged_samples")};

constexpr std::array kTileErrors{column<&TileErrorRow::job>("job"),
                                 column<&TileErrorRow::frame>("frame"),
                                 column<&TileErrorRow::tile>("tile"),
                                 column<&TileErrorRow::error, &TileError::samples>("samples"),
                                 column<&TileErrorRow::error, &TileError::variance>("relative_variance"),
                                 column<&TileErrorRow::error, &TileError::earlier>("earlier_variance"),
                                 column<&TileErrorRow::errorSquares>("error_squares"),
                                 column<&TileErrorRow::borrowedVariance>("borrowed_variance"),
                                 column<&TileErrorRow::errorTail>("error_tail"),
                                 column<&TileErrorRow::droppedSamples>("dropped_samples")};

constexpr std::array kLevels{column<&LevelRow::job>("job"),
                             column<&LevelRow::frame>("frame"),
                             column<&LevelRow::samples>("samples"),
                             column<&LevelRow::tiles>("tiles"),
                             column<&LevelRow::relativeVariance>("relative_variance"),
                             column<&LevelRow::errorSquares>("error_squares"),
                             column<&LevelRow::borrowedVariance>("borrowed_variance"),
                             column<&LevelRow::errorTail>("error_tail"),
                             column<&LevelRow::droppedSamples>("dropped_samples"),
                             column<&LevelRow::relativeError>("relative_error"),
                             column<&LevelRow::deviceSeconds>("device_seconds")};

constexpr std::array kPasses{column<&PassRow::job>("job"),
                             column<&PassRow::frame>("frame"),
                             column<&PassRow::tile>("tile"),
                             column<&PassRow::samples, &SampleRange::first>("first_sample"),
                             column<&PassRow::samples, &SampleRange::count>("samples"),
                             column<&PassRow::state>("state"),
                             column<&PassRow::epoch>("epoch"),
                             heldColumn<&HeldPass::file>("held_file"),
                             heldColumn<&HeldPass::offset>("held_offset"),
                             column<&PassRow::queuedAt>("queued_at")};

constexpr std::array kLeasedPasses{column<&LeasedPass::tile>("tile"),
                                   column<&LeasedPass::samples, &SampleRange::first>("first_sample"),
                                   column<&LeasedPass::samples, &SampleRange::count>("samples")};

constexpr std::array kLeases{column<&LeaseRow::epoch>("epoch"),     column<&LeaseRow::id>("id"),
                             column<&LeaseRow::worker>("worker"),   column<&LeaseRow::job>("job"),
                             column<&LeaseRow::frame>("frame"),     column<&LeaseRow::state>("state"),
                             column<&LeaseRow::granted>("granted"), column<&LeaseRow::passes>("passes"),
                             column<&LeaseRow::session>("session"), column<&LeaseRow::machine>("machine"),
                             column<&LeaseRow::loss>("loss")};

constexpr std::array kDeadlyPasses{column<&DeadlyPass::frame>("frame"), column<&DeadlyPass::tile>("tile"),
                                   column<&DeadlyPass::firstSample>("first_sample"),
                                   column<&DeadlyPass::deaths>("deaths")};

constexpr std::array kFailures{
    column<&FailureRow::job>("job"),        column<&FailureRow::frame>("frame"),
    column<&FailureRow::tile>("tile"),      column<&FailureRow::firstSample>("first_sample"),
    column<&FailureRow::worker>("worker"),  column<&FailureRow::message>("message"),
    column<&FailureRow::reports>("reports")};

constexpr std::array kWorkers{column<&WorkerRow::hello, &WorkerHello::worker>("worker"),
                              column<&WorkerRow::hello, &WorkerHello::host>("host"),
                              column<&WorkerRow::hello, &WorkerHello::device>("device"),
                              column<&WorkerRow::hello, &WorkerHello::driver>("driver"),
                              column<&WorkerRow::hello, &WorkerHello::version>("version"),
                              column<&WorkerRow::state>("state"),
                              column<&WorkerRow::reason>("reason"),
                              column<&WorkerRow::firstSeen>("first_seen"),
                              column<&WorkerRow::lastSeen>("last_seen")};

constexpr std::array kContributions{
    column<&ContributionRow::job>("job"), column<&ContributionRow::worker>("worker"),
    column<&ContributionRow::deviceSeconds>("device_seconds"), column<&ContributionRow::passes>("passes"),
    column<&ContributionRow::samples>("samples")};

constexpr std::array kReports{column<&ReportRow::job>("job"), column<&ReportRow::worker>("worker"),
                              column<&ReportRow::json>("json")};

constexpr std::array kEvents{column<&EventRow::id>("id"),        column<&EventRow::job>("job"),
                             column<&EventRow::jobId>("job_id"), column<&EventRow::at>("at"),
                             column<&EventRow::type>("type"),    column<&EventRow::json>("json")};

constexpr std::array kStudies{
    column<&StudyRow::key>("key"),         column<&StudyRow::id>("id"),
    column<&StudyRow::state>("state"),     column<&StudyRow::requestJson>("request"),
    column<&StudyRow::created>("created"), column<&StudyRow::finished>("finished"),
    column<&StudyRow::fault>("fault")};

constexpr std::array kStudyCells{column<&StudyCellRow::study>("study"), column<&StudyCellRow::cell>("cell"),
                                 column<&StudyCellRow::resultJson>("result"),
                                 column<&StudyCellRow::picturesJson>("pictures")};

}  // namespace

template <>
std::span<const Column<JobRow>> columnsOf() {
    return kJobs;
}
template <>
std::span<const Column<FrameRow>> columnsOf() {
    return kFrames;
}
template <>
std::span<const Column<TileRow>> columnsOf() {
    return kTiles;
}
template <>
std::span<const Column<TileErrorRow>> columnsOf() {
    return kTileErrors;
}
template <>
std::span<const Column<LevelRow>> columnsOf() {
    return kLevels;
}
template <>
std::span<const Column<PassRow>> columnsOf() {
    return kPasses;
}
template <>
std::span<const Column<LeasedPass>> columnsOf() {
    return kLeasedPasses;
}
template <>
std::span<const Column<LeaseRow>> columnsOf() {
    return kLeases;
}
template <>
std::span<const Column<DeadlyPass>> columnsOf() {
    return kDeadlyPasses;
}
template <>
std::span<const Column<FailureRow>> columnsOf() {
    return kFailures;
}
template <>
std::span<const Column<WorkerRow>> columnsOf() {
    return kWorkers;
}
template <>
std::span<const Column<ContributionRow>> columnsOf() {
    return kContributions;
}
template <>
std::span<const Column<ReportRow>> columnsOf() {
    return kReports;
}
template <>
std::span<const Column<EventRow>> columnsOf() {
    return kEvents;
}
template <>
std::span<const Column<StudyRow>> columnsOf() {
    return kStudies;
}
template <>
std::span<const Column<StudyCellRow>> columnsOf() {
    return kStudyCells;
}

}  // namespace tilefarm
