#include "server/api/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "server/report/accuracy.h"
#include "server/report/job_faults.h"
#include "shared/error/error.h"
#include "shared/film/notices.h"
#include "shared/job/frames.h"
#include "shared/job/image_spec.h"
#include "shared/job/wire.h"

namespace tilefarm {

using nlohmann::json;

namespace {
json maybe(const std::optional<TimePoint>& time) {
    return time ? json(rfc3339(*time)) : json();
}
json maybe(const std::optional<double>& value) {
    return value ? json(*value) : json();
}
// The frame in work, or the last one.
int32_t currentFrame(const JobRow& job, const json& frames) {
    const FrameSet set{frames.at("first").get<int32_t>(), frames.at("count").get<uint32_t>(),
                       frames.value("step", 1u), frames.value("list", "")};
    return frameNumbers(set).at(std::min(job.framesDone, job.frames - 1));
}
}  // namespace

std::string rfc3339(TimePoint time) {
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss clock(time - day);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                       clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                       clock.subseconds().count());
}

std::string dump(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

json jobView(const ConstTables& t, const JobRow& job, SpecView specView) {
    const json outline = json::parse(job.outlineJson);
    const json& size = outline.at("image");
    const ImageSpec image{.width = size.at("width"), .height = size.at("height")};
    json view{
        {"id", job.id},
        {"state", toString(job.state)},
        {"spec", specView == SpecView::whole ? json::parse(t.jobs.spec(job.key)) : outline},
        {"createdAt", rfc3339(job.created)},
        {"startedAt", maybe(job.started)},
        {"finishedAt", maybe(job.finished)},
        {"progress",
         {{"passes", job.passes}, {"passesMerged", job.passesMerged}, {"fraction", job.fractionDone()}}},
        {"samplesMerged", job.samplesMerged},
        {"relativeError", maybe(job.relativeError)},
        {"deviceSeconds", job.deviceSeconds},
        {"droppedSamples", job.droppedSamples},
        {"framesDone", job.framesDone},
        {"setAside", job.setAside.empty() ? json() : json(job.setAside)},
        {"faults", faultsOf(job)},
        {"notices", noticesOf(job)},
        {"flagged", isFlagged(job)},
        {"numerics", numericsOf(job)}};
    const int32_t current = currentFrame(job, outline.at("frames"));
    addStop(view, t.frames.find(job.key, current).value_or(FrameRow{}), stopFromJson(outline.at("stop")));
    const auto accuracy = addAccuracy(view, t, job.key, current, image);
    if (accuracy)
        for (const std::string& notice : noticesOf(*accuracy)) view["notices"].push_back(notice);
    return view;
}

json frameView(const FrameRow& frame, const StopCondition& stop) {
    json view{{"frame", frame.frame},
              {"state", toString(frame.state)},
              {"samplesMerged", frame.samplesMerged},
              {"relativeError", maybe(frame.relativeError)},
              {"deviceSeconds", frame.deviceSeconds},
              {"droppedSamples", frame.droppedSamples},
              {"passesMerged", frame.passesMerged},
              {"revision", frame.revision}};
    addStop(view, frame, stop);
    return view;
}

json eventView(const EventRow& event) {
    return {{"id", event.id},
            {"job", event.jobId.empty() ? json() : json(event.jobId)},
            {"at", rfc3339(event.at)},
            {"type", event.type},
            {"data", json::parse(event.json)}};
}

json workerView(const WorkerRow& worker, double samplesPerSecond) {
    return {{"worker", worker.hello.worker},
            {"host", worker.hello.host},
            {"device", worker.hello.device},
            {"driver", worker.hello.driver},
            {"version", worker.hello.version},
            {"state", toString(worker.state)},
            {"reason", worker.reason},
            {"firstSeen", rfc3339(worker.firstSeen)},
            {"lastSeen", rfc3339(worker.lastSeen)},
            {"samplesPerSecond", samplesPerSecond}};
}

JobRow requireJob(const ConstTables& t, const std::string& id) {
    if (auto job = t.jobs.find(id)) return *job;
    throw Error(ErrorCode::notFound, "there is no job '" + id + "'");
}

int32_t frameNumber(const std::string& text) {
    int32_t number = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc{} || end != text.data() + text.size()) {
        throw Error(ErrorCode::notFound, "'" + text + "' is no frame number");
    }
    return number;
}

}  // namespace tilefarm
