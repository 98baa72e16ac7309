#include <charconv>
#include <nlohmann/json.hpp>

#include "server/api/accepted_job.h"
#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "server/report/accuracy.h"
#include "server/report/forecasts.h"
#include "server/report/job_report.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

HttpResponse viewOf(Services& s, const std::string& id, int status) {
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        response = jsonResponse(status, dump(jobView(t, requireJob(t, id), SpecView::whole)));
    });
    return response;
}

JobKey keyFromCursor(const HttpRequest& r) {
    return static_cast<JobKey>(r.queriedInteger("cursor", 1, INT64_MAX, INT64_MAX));
}

}  // namespace

HttpResponse postJob(Services& s, HttpRequest& r) {
    const std::string body = r.body(s.config.mostJsonBytes);
    JobSpec spec = jobFromJson(parseJson(body));
    spec = acceptedJob(s, std::move(spec));
    if (const auto validate = r.queried("validate")) {
        if (*validate != "only") {
            throw Error(ErrorCode::invalidArgument, "query parameter 'validate' may only be 'only'",
                        {{"validate", "must be 'only'"}});
        }
        const JobInfo info(0, {}, spec);
        return jsonResponse(200, dump({{"valid", true},
                                       {"passes", info.passes()},
                                       {"tiles", info.grid.count()},
                                       {"frames", spec.frames.count}}));
    }
    s.requireDiskSpace(0);
    const auto submission = s.scheduler.submit(spec, r.header("Idempotency-Key"), sha256Hex(body));
    auto response = viewOf(s, submission.job.id, submission.created ? 201 : 200);
    response.headers.emplace("Location", "/v1/jobs/" + submission.job.id);
    return response;
}

HttpResponse listJobs(Services& s, HttpRequest& r) {
    JobQuery query;
    if (const auto state = r.queried("state")) query.state = jobStateFrom(*state);
    const size_t limit = r.queriedInteger("limit", 1, 1000, 50);
    query.before = keyFromCursor(r);
    query.limit = limit + 1;  // one more, to know whether there is a next page
    json list = json::array(), next;
    s.store.read([&](const ConstTables& t) {
        auto jobs = t.jobs.list(query);
        if (jobs.size() > limit) {
            jobs.pop_back();
            next = std::to_string(jobs.back().key);
        }
        for (const JobRow& job : jobs) list.push_back(jobView(t, job, SpecView::outline));
    });
    return jsonResponse(200, dump({{"jobs", list}, {"next", next}}));
}

HttpResponse getJob(Services& s, HttpRequest& r) {
    return viewOf(s, r.parameter("job"), 200);
}

HttpResponse cancelJob(Services& s, HttpRequest& r) {
    return viewOf(s, s.scheduler.cancel(r.parameter("job")).id, 200);
}

HttpResponse pauseJob(Services& s, HttpRequest& r) {
    return viewOf(s, s.scheduler.pause(r.parameter("job")).id, 200);
}

HttpResponse resumeJob(Services& s, HttpRequest& r) {
    return viewOf(s, s.scheduler.resume(r.parameter("job")).id, 200);
}

HttpResponse getReport(Services& s, HttpRequest& r) {
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        const JobRow job = requireJob(t, r.parameter("job"));
        json report = jobReport(t, job);
        const auto info = s.scheduler.catalog().get(t, job);
        for (const FrameRow& frame : t.frames.list(job.key)) {
            json view{{"frame", frame.frame},
                      {"deviceSeconds", frame.deviceSeconds},
                      {"forecast", keptForecast(frame)}};
            addStop(view, frame, info->spec.stop);
            addAccuracy(view, t, job.key, frame.frame, info->spec.image);
            report["frames"].push_back(view);
        }
        response = jsonResponse(200, dump(report));
    });
    return response;
}

}  // namespace tilefarm
