#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "server/cli/table.h"
#include "shared/error/error.h"
#include "shared/farm_client/http_status.h"
#include "shared/file/durable_file.h"
#include "shared/job/safe_path.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr Milliseconds kLookEvery{500};
constexpr Milliseconds kMayBeAway{120'000};

// 10 and true as such; all that is no JSON is a word.
json valueOf(const std::string& text) {
    const json value = json::parse(text, nullptr, false);
    return value.is_discarded() ? json(text) : value;
}

json knobOf(const std::string& words) {
    const size_t equals = words.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == words.size())
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("--knob '{}' must be like settings.clampIndirect=1,10", words));
    const std::string text = words.substr(equals + 1);
    json values = json::parse(text, nullptr, false);
    if (!values.is_array()) {
        values = json::array();
        for (size_t from = 0; from <= text.size();) {
            const size_t end = std::min(text.find(',', from), text.size());
            values.push_back(valueOf(text.substr(from, end - from)));
            from = end + 1;
        }
    }
    return {{"path", words.substr(0, equals)}, {"values", values}};
}

json requestOf(const StudyOptions& options, const JobSpec& base) {
    json request{{"job", toJson(base)},
                 {"knobs", json::array()},
                 {"grid", options.grid},
                 {"seeds", options.seeds},
                 {"priority", options.priority}};
    for (const std::string& knob : options.knobs) request["knobs"].push_back(knobOf(knob));
    if (!options.samples.empty()) request["samples"] = options.samples;
    if (options.referenceSamples > 0) request["reference"] = {{"samples", options.referenceSamples}};
    return request;
}

// Rides out a server that restarts.
json waitForStudy(FarmClient& farm, const std::string& id, const Console& console) {
    TimePoint heard = console.clock.now();
    std::string said;
    while (true) {
        try {
            const json view = farm.study(id);
            heard = console.clock.now();
            if (view.at("state") != "running") return view;
            const json& progress = view.at("progress");
            const std::string words =
                fmt::format("{} of {} jobs, {} of {} comparisons", progress.at("jobsDone").get<int>(),
                            progress.at("jobs").get<int>(), progress.at("cellsMeasured").get<int>(),
                            progress.at("cells").get<int>());
            if (words != said) console.err << words << std::endl;
            said = words;
        } catch (const Error& fault) {
            if (fault.code != ErrorCode::unavailable || console.clock.now() - heard > kMayBeAway) throw;
        }
        console.sleep(kLookEvery);
    }
}

std::string figure(const json& value) {
    return value.is_number() ? fmt::format("{:.3g}", value.get<double>()) : "-";
}

void printStudy(const json& view, std::ostream& out) {
    out << fmt::format("study {}  {}  {}\n", view.at("id").get<std::string>(),
                       view.at("state").get<std::string>(), printable(view.at("name")));
    if (view.at("fault").is_string()) out << "  error: " << printable(view.at("fault")) << '\n';
    const json& result = view.at("result");
    if (result.at("verdict").is_string()) out << printable(result.at("verdict")) << "\n\n";
    std::vector<TableRow> rows{
        {"VARIANT", "SAMPLES", "SECONDS", "MSE", "VARIANCE", "BIAS %", "Z", "X BASE", "95 %", "FRONT"}};
    for (const json& variant : result.at("variants")) {
        for (const json& cell : variant.at("cells")) {
            const json ratio = cell.at("efficiencyRatio");
            rows.push_back(
                {variant.at("label"), cell.at("samples").dump(), figure(cell.at("deviceSeconds").at("value")),
                 figure(cell.at("mse").at("value")), figure(cell.at("variance")),
                 figure(cell.at("bias").at("percent")), figure(cell.at("bias").at("z")),
                 ratio.is_object() ? figure(ratio.at("value")) : "-",
                 ratio.is_object() ? figure(ratio.at("low")) + " .. " + figure(ratio.at("high")) : "-",
                 cell.at("pareto") == true ? "*" : ""});
        }
    }
    printTable(rows, out);
}

const char* resourceOf(const std::filesystem::path& report) {
    if (hasSuffix(report.string(), ".html")) return "/report.html";
    if (hasSuffix(report.string(), ".csv")) return "/report.csv";
    if (hasSuffix(report.string(), ".json")) return "";
    throw Error(ErrorCode::invalidArgument,
                fmt::format("the report '{}' must end with .html, .csv or .json", report.string()));
}

}  // namespace

int showStudy(FarmClient& farm, const std::string& id, bool wait,
              const std::vector<std::filesystem::path>& reports, const Console& console) {
    for (const auto& report : reports) resourceOf(report);
    const json view = wait || !reports.empty() ? waitForStudy(farm, id, console) : farm.study(id);
    for (const auto& report : reports)
        farm.download("/v1/studies/" + percentEncoded(id) + resourceOf(report), report);
    printStudy(view, console.out);
    return wait && view.at("state") != "completed" ? kFailed : kDone;
}

int submitStudy(FarmClient& farm, const StudyOptions& options, const Console& console) {
    for (const auto& report : options.reports) resourceOf(report);
    for (const std::string& knob : options.knobs) knobOf(knob);  // before anything is sent
    const JobSpec base = uploadScene(farm, options.base, console);
    const std::string id = farm.submitStudy(requestOf(options, base)).at("id");
    console.out << id << std::endl;
    if (!options.wait && options.reports.empty()) return kDone;
    return showStudy(farm, id, true, options.reports, console);
}

int showStudies(FarmClient& farm, bool asJson, const Console& console) {
    const json list = farm.studies("limit=1000").at("studies");
    if (asJson) {
        console.out << list.dump(2) << '\n';
        return kDone;
    }
    std::vector<TableRow> rows{{"STUDY", "STATE", "CREATED", "NAME"}};
    for (const json& study : list)
        rows.push_back({study.at("id"), study.at("state"), study.at("createdAt"), study.at("name")});
    printTable(rows, console.out);
    return kDone;
}

int cancelStudy(FarmClient& farm, const std::string& id, const Console& console) {
    const json view = farm.cancelStudy(id);
    console.out << fmt::format("study {} is {}\n", id, view.at("state").get<std::string>());
    return kDone;
}

}  // namespace tilefarm
