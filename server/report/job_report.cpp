#include "server/report/job_report.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "server/report/job_faults.h"

namespace tilefarm {

using nlohmann::json;

namespace {

struct DeviceTotal {
    double seconds = 0;
    uint64_t samples = 0, passes = 0;
    std::set<std::string> drivers;
};

double perSecond(uint64_t samples, double seconds) {
    return seconds > 0 ? static_cast<double>(samples) / seconds : 0;
}

json deviceList(const std::map<std::string, DeviceTotal>& totals) {
    json list = json::array();
    for (const auto& [device, total] : totals) {
        list.push_back({{"device", device},
                        {"drivers", total.drivers},
                        {"deviceSeconds", total.seconds},
                        {"passes", total.passes},
                        {"samples", total.samples},
                        {"samplesPerSecond", perSecond(total.samples, total.seconds)}});
    }
    return list;
}

// Workers report what they saw in the scene; the same warning of several workers is told once.
json mergedReports(const std::vector<ReportRow>& rows) {
    std::set<json> warnings, used, leftOut;
    json perWorker = json::array();
    for (const ReportRow& row : rows) {
        const json report = json::parse(row.json);
        const auto collect = [](const json& list, std::set<json>& into) {
            if (list.is_array()) into.insert(list.begin(), list.end());
        };
        collect(report.value("warnings", json::array()), warnings);
        const json features = report.value("features", json::object());
        if (features.is_object()) {
            collect(features.value("used", json::array()), used);
            collect(features.value("leftOut", json::array()), leftOut);
        }
        perWorker.push_back({{"worker", row.worker}, {"report", report}});
    }
    return {{"warnings", warnings},
            {"features", {{"used", used}, {"leftOut", leftOut}}},
            {"workerReports", perWorker}};
}

// What loading the scene had to leave out or mend; every worker loads the same one.
json sceneFaults(const std::vector<ReportRow>& rows) {
    json faults{{"degenerateTriangles", 0}, {"sanitisedTexels", 0}};
    for (const ReportRow& row : rows) {
        const json counts = json::parse(row.json).value("counts", json::object());
        if (!counts.is_object()) continue;
        for (auto& [key, most] : faults.items()) {
            const json count = counts.value(key, json(0));
            if (count.is_number_unsigned() && count > most) most = count;
        }
    }
    return faults;
}

}  // namespace

json jobReport(const ConstTables& t, const JobRow& job) {
    std::map<std::string, WorkerHello> hellos;
    for (const WorkerRow& worker : t.workers.list()) hellos[worker.hello.worker] = worker.hello;
    std::map<std::string, DeviceTotal> devices;
    json workers = json::array();
    for (const ContributionRow& row : t.workers.contributions(job.key)) {
        const WorkerHello& hello = hellos[row.worker];
        DeviceTotal& device = devices[hello.device];
        device.seconds += row.deviceSeconds;
        device.samples += row.samples;
        device.passes += row.passes;
        device.drivers.insert(hello.driver);
        workers.push_back({{"worker", row.worker},
                           {"host", hello.host},
                           {"device", hello.device},
                           {"driver", hello.driver},
                           {"deviceSeconds", row.deviceSeconds},
                           {"passes", row.passes},
                           {"samples", row.samples},
                           {"samplesPerSecond", perSecond(row.samples, row.deviceSeconds)}});
    }
    json report = mergedReports(t.workers.reports(job.key));
    report["job"] = job.id;
    report["state"] = toString(job.state);
    report["deviceSeconds"] = job.deviceSeconds;
    report["droppedSamples"] = job.droppedSamples;
    report["relativeError"] = job.relativeError ? json(*job.relativeError) : json();
    report["wallSeconds"] = job.started && job.finished
                                ? json(static_cast<double>((*job.finished - *job.started).count()) / 1000)
                                : json();
    report["devices"] = deviceList(devices);
    report["workers"] = workers;
    report["faults"] = faultsOf(job);
    report["notices"] = noticesOf(job);
    report["flagged"] = isFlagged(job);
    report["numerics"] = numericsOf(job);
    report["numerics"].update(sceneFaults(t.workers.reports(job.key)));
    report["frames"] = json::array();
    return report;
}

}  // namespace tilefarm
