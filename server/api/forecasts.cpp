#include "server/report/forecasts.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "server/api/accepted_job.h"
#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/job/json_reader.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint32_t kUsualPilotSamples = 16, kLeastPilotSamples = 8, kMostPilotSamples = 4096;
constexpr int32_t kPilotPriority = 90;
constexpr size_t kMostTargets = 16;

// What POST /v1/forecasts takes.
struct Wanted {
    json job;
    uint32_t samples = kUsualPilotSamples;
};

Wanted wantedFrom(const json& body) {
    Faults faults;
    Wanted wanted;
    if (!body.is_object())
        throw Error(ErrorCode::invalidArgument, "a forecast is asked for by a JSON object");
    for (const auto& [name, value] : body.items()) {
        if (name == "job")
            wanted.job = value;
        else if (name != "samples")
            faults.add("/" + pointerToken(name), "unknown member");
        else if (!value.is_number_unsigned() || value < kLeastPilotSamples || value > kMostPilotSamples)
            faults.add("/samples", "must be a whole number from 8 to 4096");
        else
            wanted.samples = value;
    }
    if (!body.contains("job")) faults.add("/job", "is missing: the job to forecast");
    faults.throwIfAny(ErrorCode::invalidArgument, "the request for a forecast");
    return wanted;
}

// Its faults stand in the request, not in a job by itself.
JobSpec jobWithin(const Services& s, const json& job) {
    try {
        return acceptedJob(s, jobFromJson(job));
    } catch (const Error& error) {
        Faults faults;
        faults.addBelow("/job", error);
        faults.throwIfAny(error.code, "the request for a forecast");
        throw;
    }
}

// Few samples of the first frame, measured tile by tile where the job will send its samples where the error
// is.
JobSpec pilotOf(JobSpec spec, uint32_t samples) {
    spec.name = "forecast of " + spec.name;
    spec.priority = std::max(spec.priority, kPilotPriority);
    spec.frames = {frameNumbers(spec.frames).front(), 1};
    const double target = spec.stop.relativeError > 0 ? spec.stop.relativeError : 0;
    spec.stop = {.samples = samples, .relativeError = target, .minSamples = samples};
    return spec;
}

std::vector<double> targetsFrom(const std::string& list) {
    std::vector<double> targets;
    for (const char *at = list.data(), *end = at + list.size(); at <= end;) {
        double target = 0;
        const auto [next, failed] = std::from_chars(at, end, target);
        const bool ends = next == end || *next == ',';
        if (failed != std::errc() || !ends || !(target > 0 && target <= 1e6) ||
            targets.size() == kMostTargets)
            throw Error(
                ErrorCode::invalidArgument, "query parameter 'relativeError' is a list of error targets",
                {{"relativeError", "must be up to 16 numbers above 0, separated by commas: 0.05,0.01"}});
        targets.push_back(target);
        at = next + 1;
    }
    return targets;
}

}  // namespace

HttpResponse getForecast(Services& s, HttpRequest& r) {
    const auto list = r.queried("relativeError");
    const std::vector<double> targets = list ? targetsFrom(*list) : kUsualTargets;
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        const JobRow job = requireJob(t, r.parameter("job"));
        const auto info = s.scheduler.catalog().get(t, job);
        const auto frames =
            static_cast<uint32_t>(r.queriedInteger("frames", 1, 1'000'000, info->spec.frames.count));
        response = jsonResponse(200, dump(forecastView(t, job, info->spec, targets, frames)));
    });
    return response;
}

HttpResponse postForecast(Services& s, HttpRequest& r) {
    const std::string body = r.body(s.config.mostJsonBytes);
    const Wanted wanted = wantedFrom(parseJson(body));
    const JobSpec spec = jobWithin(s, wanted.job);
    s.requireDiskSpace(0);
    const auto submission =
        s.scheduler.submit(pilotOf(spec, wanted.samples), r.header("Idempotency-Key"), sha256Hex(body));
    const std::string& id = submission.job.id;
    std::string forecast = "/v1/jobs/" + id + "/forecast?frames=" + std::to_string(spec.frames.count);
    if (spec.stop.relativeError > 0) {
        forecast += "&relativeError=" + json(spec.stop.relativeError).dump();
        for (const double usual : kUsualTargets) forecast += "," + json(usual).dump();
    }
    auto response =
        jsonResponse(submission.created ? 201 : 200, dump({{"pilot", id}, {"forecast", forecast}}));
    response.headers.emplace("Location", forecast);
    return response;
}

}  // namespace tilefarm
