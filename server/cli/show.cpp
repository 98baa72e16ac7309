#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "server/cli/commands.h"
#include "server/cli/progress.h"
#include "server/cli/table.h"
#include "shared/farm_client/http_status.h"

namespace tilefarm {

namespace {

using nlohmann::json;

// A member as text; "-" where it is absent or null.
std::string cell(const json& object, const char* name) {
    const auto found = object.find(name);
    if (found == object.end() || found->is_null()) return "-";
    if (found->is_number_float()) return fmt::format("{:.4g}", found->get<double>());
    return found->is_string() ? found->get<std::string>() : found->dump();
}

std::string percent(const json& view) {
    return fmt::format("{:.0f} %", 100 * view.value("/progress/fraction"_json_pointer, 0.0));
}

// All pages of the list.
json allJobs(FarmClient& farm, const std::string& state) {
    json all = json::array();
    const std::string filter = state.empty() ? "limit=500" : "limit=500&state=" + percentEncoded(state);
    std::string query = filter;
    while (true) {
        const json page = farm.jobs(query);
        for (const json& view : page.at("jobs")) all.push_back(view);
        if (!page.contains("next") || !page["next"].is_string()) return all;
        query = filter + "&cursor=" + percentEncoded(page["next"].get<std::string>());
    }
}

std::string frameWords(const FrameSet& frames) {
    if (frames.count == 1) return fmt::format("frame {}", frames.first);
    if (!frames.list.empty() || frames.step != 1)
        return fmt::format("{} frames: {}", frames.count, textOf(frames));
    return fmt::format("frames {} to {}", frames.first, frames.first + int64_t{frames.count} - 1);
}

// When a frame is complete.
std::string stopWords(const json& stop) {
    std::string words = cell(stop, "samples") + " samples";
    const auto add = [&](const char* member, const char* format) {
        if (const double value = stop.value(member, 0.0); value > 0)
            words += fmt::format(fmt::runtime(format), value);
    };
    add("relativeError", " or a relative error of {}");
    add("deviceSeconds", " or {} device seconds");
    add("wallSeconds", " or {} seconds");
    return words;
}

// What the number is worth, as far as the server knows.
std::string accuracyWords(const json& view) {
    std::string words;
    if (const json range = view.value("relativeErrorInterval", json()); range.is_array() && range.size() == 2)
        words += fmt::format(", 95 % in {:.4g} .. {:.4g}", range[0].get<double>(), range[1].get<double>());
    if (const json tail = view.value("errorTail", json()); tail.is_object())
        words += fmt::format("; the worst 0.1 % of pixels hold {:.0f} % of its square",
                             100 * tail.at("worstShare").get<double>());
    return words;
}

// As --pixel of tilefarm-worker render takes them.
std::string worstPixels(const json& view) {
    const json tail = view.value("errorTail", json());
    if (!tail.is_object()) return {};
    std::string words;
    for (const json& pixel : tail.at("pixels"))
        words += fmt::format(" {},{}", pixel.at("x").get<uint32_t>(), pixel.at("y").get<uint32_t>());
    return words;
}

void printJob(const json& view, std::ostream& out) {
    const json& spec = view.at("spec");
    const json& image = spec.at("image");
    out << fmt::format("job {}  {}  {}\n", cell(view, "id"), cell(view, "state"),
                       printable(cell(spec, "name")));
    out << fmt::format("  scene           {}, camera {}\n", printable(cell(spec.at("scene"), "entry")),
                       printable(cell(spec, "camera")));
    out << fmt::format("  image           {} x {}, {}, {}\n", cell(image, "width"), cell(image, "height"),
                       stopWords(spec.at("stop")), frameWords(framesOf(spec)));
    out << fmt::format("  progress        {}, {} samples of the current frame\n", percent(view),
                       cell(view, "samplesMerged"));
    if (cell(view, "stopped") != "-") out << fmt::format("  stopped         {}\n", cell(view, "stopped"));
    out << fmt::format("  relative error  {}{}\n", cell(view, "relativeError"), accuracyWords(view));
    if (const std::string pixels = worstPixels(view); !pixels.empty())
        out << fmt::format("  worst pixels   {}\n", pixels);
    out << fmt::format("  device seconds  {}\n", cell(view, "deviceSeconds"));
    out << fmt::format("  dropped samples {}\n", cell(view, "droppedSamples"));
    out << fmt::format("  created         {}\n  started         {}\n  finished        {}\n",
                       cell(view, "createdAt"), cell(view, "startedAt"), cell(view, "finishedAt"));
    if (const json curve = view.value("errorCurve", json::array()); !curve.empty()) {
        std::vector<TableRow> rows{{"  samples", "relative error", "device seconds"}};
        for (const json& point : curve)
            rows.push_back(
                {"  " + cell(point, "samples"), cell(point, "relativeError"), cell(point, "deviceSeconds")});
        printTable(rows, out);
    }
    for (const json& fault : view.value("faults", json::array()))
        out << "  error: " << printable(fault.is_string() ? fault.get<std::string>() : fault.dump()) << '\n';
    for (const json& notice : view.value("notices", json::array()))
        out << "  note: " << printable(notice.get<std::string>()) << '\n';
}

}  // namespace

int showJobs(FarmClient& farm, const std::string& state, bool asJson, const Console& console) {
    const json jobs = allJobs(farm, state);
    if (asJson) {
        console.out << jobs.dump(2) << '\n';
        return kDone;
    }
    std::vector<TableRow> rows{{"JOB", "STATE", "DONE", "ERROR", "CREATED", "NAME"}};
    for (const json& view : jobs)
        rows.push_back({cell(view, "id"), cell(view, "state"), percent(view), cell(view, "relativeError"),
                        cell(view, "createdAt"), cell(view.at("spec"), "name")});
    printTable(rows, console.out);
    return kDone;
}

int showJob(FarmClient& farm, const std::string& id, bool asJson, const Console& console) {
    const json view = farm.job(id);
    if (asJson)
        console.out << view.dump(2) << '\n';
    else
        printJob(view, console.out);
    return kDone;
}

int showWorkers(FarmClient& farm, bool asJson, const Console& console) {
    const json answer = farm.workers();
    if (asJson) {
        console.out << answer.at("workers").dump(2) << '\n';
        return kDone;
    }
    std::vector<TableRow> rows{{"WORKER", "STATE", "HOST", "DEVICE", "SAMPLES/S", "LAST SEEN"}};
    for (const json& worker : answer.at("workers"))
        rows.push_back({cell(worker, "worker"), cell(worker, "state"), cell(worker, "host"),
                        cell(worker, "device"), cell(worker, "samplesPerSecond"), cell(worker, "lastSeen")});
    printTable(rows, console.out);
    return kDone;
}

namespace {

std::string secondsText(double seconds) {
    return seconds < 100 ? fmt::format("{:.3g} s", seconds)
                         : clockFace(std::chrono::seconds(std::llround(seconds)));
}

std::string secondsCell(const json& seconds) {
    if (seconds.is_null()) return "-";
    const json& interval = seconds.at("interval");
    return fmt::format("{} ({} to {})", secondsText(seconds.at("value")), secondsText(interval.at(0)),
                       secondsText(interval.at(1)));
}

TableRow forecastRow(const std::string& name, const json& expected) {
    if (expected.is_null()) return {name, "beyond 65536", "-", "-"};
    return {name, fmt::format("{:.0f}", expected.at("samples").get<double>()),
            secondsCell(expected.at("deviceSeconds")), secondsCell(expected.at("wallSeconds"))};
}

}  // namespace

int showForecast(FarmClient& farm, const std::string& path, bool asJson, const Console& console) {
    const json view = farm.forecast(path);
    if (asJson) {
        console.out << view.dump(2) << '\n';
        return kDone;
    }
    const json& basis = view.at("basis");
    if (basis.is_null()) {
        console.err << "nothing is known yet: three pass levels of a frame have to be complete\n";
        return kFailed;
    }
    console.err << fmt::format(
        "told from {} samples per pixel with a relative error of {:.3g} %, for {} frame{} and "
        "{} worker{}\n",
        basis.at("samples").get<uint32_t>(), basis.at("relativeError").get<double>() * 100,
        view.at("frames").get<uint32_t>(), view.at("frames") == 1 ? "" : "s", view.at("workers").size(),
        view.at("workers").size() == 1 ? "" : "s");
    std::vector<TableRow> rows{{"RELATIVE ERROR", "SAMPLES", "DEVICE TIME", "TIME"}};
    for (const json& target : view.at("targets"))
        rows.push_back(forecastRow(fmt::format("{:.3g} %", target.at("relativeError").get<double>() * 100),
                                   target.at("forecast")));
    printTable(rows, console.out);
    return kDone;
}

int moveJob(FarmClient& farm, const std::string& id, Move move, const Console& console) {
    const json view = move == Move::cancel  ? farm.cancel(id)
                      : move == Move::pause ? farm.pause(id)
                                            : farm.resume(id);
    console.out << fmt::format("job {} is {}\n", id, cell(view, "state"));
    return kDone;
}

}  // namespace tilefarm
