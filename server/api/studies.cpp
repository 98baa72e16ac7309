#include <map>
#include <nlohmann/json.hpp>

#include "server/api/accepted_job.h"
#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "server/study/page.h"
#include "server/study/result.h"
#include "shared/error/error.h"
#include "shared/job/json_reader.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

StudyRow requireStudy(const ConstTables& t, const std::string& id) {
    if (auto study = t.studies.find(id)) return *study;
    throw Error(ErrorCode::notFound, "there is no study '" + id + "'");
}

StudyPlan planOf(const StudyRow& row) {
    return StudyPlan(studyFromJson(json::parse(row.requestJson)));
}

json outlineOf(const StudyRow& row) {
    return {{"id", row.id},
            {"name", json::parse(row.requestJson).at("name")},
            {"state", toString(row.state)},
            {"fault", row.fault.empty() ? json() : json(row.fault)},
            {"createdAt", rfc3339(row.created)},
            {"finishedAt", row.finished ? json(rfc3339(*row.finished)) : json()}};
}

json resultOf(const ConstTables& t, const StudyRow& row, const StudyPlan& plan) {
    std::map<uint32_t, json> measured;
    for (const StudyCellRow& cell : t.studies.cells(row.key))
        measured[cell.cell] = json::parse(cell.resultJson);
    return studyResult(plan, measured);
}

json viewOf(const ConstTables& t, const StudyRow& row) {
    const StudyPlan plan = planOf(row);
    const StudyProgress progress = StudyRunner::progress(t, row, plan);
    json view = outlineOf(row);
    view["request"] = json::parse(row.requestJson);
    view["progress"] = {{"jobs", progress.jobs},
                        {"jobsDone", progress.jobsDone},
                        {"cells", progress.cells},
                        {"cellsMeasured", progress.cellsMeasured}};
    view["referenceJob"] = progress.reference.empty() ? json() : json(progress.reference);
    view["result"] = resultOf(t, row, plan);
    return view;
}

HttpResponse answer(Services& s, const std::string& id, int status) {
    HttpResponse response;
    s.store.read(
        [&](const ConstTables& t) { response = jsonResponse(status, dump(viewOf(t, requireStudy(t, id)))); });
    return response;
}

// Of the cells at the most samples, by variant.
json picturesOf(const ConstTables& t, const StudyRow& row, const StudyPlan& plan) {
    json pictures = json::object();
    const auto count = static_cast<uint32_t>(plan.variants().size());
    const auto first = static_cast<uint32_t>(plan.cells().size()) - count;
    for (uint32_t variant = 0; variant < count; ++variant)
        if (const auto cell = t.studies.cell(row.key, first + variant))
            pictures[std::to_string(variant)] = json::parse(cell->picturesJson);
    if (const auto cell = t.studies.cell(row.key, 0))
        pictures["reference"] = json::parse(cell->picturesJson).value("reference", json());
    return pictures;
}

StudyRequest acceptedStudy(const Services& s, const json& body) {
    StudyRequest request = studyFromJson(body);
    try {
        request.job = acceptedJob(s, std::move(request.job));
    } catch (const Error& error) {
        Faults faults;
        faults.addBelow("/job", error);
        faults.throwIfAny(error.code, "the study");
    }
    const StudyPlan plan(request);  // every fault now
    for (const StudyVariant& variant : plan.variants()) requireModestTiles(jobFromJson(variant.job).image);
    return request;
}

}  // namespace

HttpResponse postStudy(Services& s, HttpRequest& r) {
    const StudyRequest request = acceptedStudy(s, parseJson(r.body(s.config.mostJsonBytes)));
    s.requireDiskSpace(0);
    const StudyRow row = s.studies.create(request);
    auto response = answer(s, row.id, 201);
    response.headers.emplace("Location", "/v1/studies/" + row.id);
    return response;
}

HttpResponse listStudies(Services& s, HttpRequest& r) {
    const size_t limit = r.queriedInteger("limit", 1, 1000, 50);
    const auto before = static_cast<int64_t>(r.queriedInteger("cursor", 1, INT64_MAX, INT64_MAX));
    json list = json::array(), next;
    s.store.read([&](const ConstTables& t) {
        auto studies = t.studies.list(before, limit + 1);  // one more, to know whether there is a next page
        if (studies.size() > limit) {
            studies.pop_back();
            next = std::to_string(studies.back().key);
        }
        for (const StudyRow& row : studies) list.push_back(outlineOf(row));
    });
    return jsonResponse(200, dump({{"studies", list}, {"next", next}}));
}

HttpResponse getStudy(Services& s, HttpRequest& r) {
    return answer(s, r.parameter("study"), 200);
}

HttpResponse cancelStudy(Services& s, HttpRequest& r) {
    return answer(s, s.studies.cancel(r.parameter("study")).id, 200);
}

HttpResponse getStudyCsv(Services& s, HttpRequest& r) {
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        const StudyRow row = requireStudy(t, r.parameter("study"));
        response = jsonResponse(200, studyCsv(resultOf(t, row, planOf(row))));
    });
    response.type = "text/csv; charset=utf-8";
    return response;
}

HttpResponse getStudyReport(Services& s, HttpRequest& r) {
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        const StudyRow row = requireStudy(t, r.parameter("study"));
        response = jsonResponse(200, studyPage(viewOf(t, row), picturesOf(t, row, planOf(row))));
    });
    response.type = "text/html; charset=utf-8";
    response.headers.emplace("Content-Security-Policy",
                             "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
                             "img-src data:");
    return response;
}

}  // namespace tilefarm
