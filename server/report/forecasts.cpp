#include "server/report/forecasts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/report/accuracy.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr size_t kLeastPoints = 3;

// Complete levels in the order of time. `pixelSamples` of the last is that of the tiles, where these differ.
std::vector<CostPoint> curveOf(const std::vector<LevelRow>& levels, const std::vector<TileError>& tiles,
                               uint64_t pixels) {
    std::vector<CostPoint> curve;
    for (const LevelRow& level : levels)
        if (level.deviceSeconds) curve.push_back({level.samples * pixels, *level.deviceSeconds});
    if (tiles.size() < 2 || curve.empty()) return curve;
    uint64_t reached = 0;
    for (const TileError& tile : tiles) reached += tile.pixels * tile.samples;
    curve.back().pixelSamples = std::max(reached, curve.back().pixelSamples);
    return curve;
}

std::vector<TileError> tilesOf(const ConstTables& t, const FrameRow& frame, const JobSpec& spec) {
    std::vector<TileError> tiles;
    if (spec.stop.relativeError <= 0) return tiles;
    const TileGrid grid(spec.image);
    for (const TileErrorRow& row : t.frames.tileErrors(frame.job, frame.frame)) {
        tiles.push_back(row.error);
        tiles.back().pixels = grid.rect(row.tile).area();
    }
    return tiles;
}

// Where all pixels are sampled alike, or no tile has been measured by itself.
TileError wholeOf(const LevelRow& level, uint64_t pixels) {
    return {.pixels = pixels,
            .samples = level.samples,
            .variance = level.relativeVariance,
            .earlier = level.relativeVariance};
}

const FrameRow* farthest(const std::vector<FrameRow>& frames) {
    const auto last = std::max_element(
        frames.begin(), frames.end(),
        [](const FrameRow& a, const FrameRow& b) { return a.samplesMerged < b.samplesMerged; });
    return last == frames.end() ? nullptr : &*last;
}

json secondsJson(double seconds, double low, double high, double times) {
    return {{"value", seconds * times}, {"interval", {low * times, high * times}}};
}

struct Farm {
    uint32_t frames = 1;
    double parallel = 0;  // device seconds per second, of the workers that took part
};

json forecastJson(const std::optional<Forecast>& f, const Farm& farm) {
    if (!f) return nullptr;
    const auto seconds = [&](double times) { return secondsJson(f->deviceSeconds, f->low, f->high, times); };
    return {{"relativeError", f->relativeError},
            {"samples", f->samples},
            {"frameDeviceSeconds", seconds(1)},
            {"deviceSeconds", seconds(farm.frames)},
            {"wallSeconds", farm.parallel > 0 ? seconds(farm.frames / farm.parallel) : json()}};
}

struct Paces {
    json workers = json::array();
    double samplesPerSecond = 0;  // of all
};

Paces pacesOf(const ConstTables& t, const JobRow& job) {
    Paces paces;
    for (const ContributionRow& row : t.workers.contributions(job.key)) {
        if (!(row.deviceSeconds > 0)) continue;
        const double pace = static_cast<double>(row.samples) / row.deviceSeconds;
        paces.samplesPerSecond += pace;
        paces.workers.push_back({{"worker", row.worker}, {"samplesPerSecond", pace}});
    }
    return paces;
}

json basisOf(const FrameRow& frame, const FrameOutlook& outlook) {
    return {{"frame", frame.frame},
            {"samples", frame.samplesMerged},
            {"relativeError", outlook.error.relativeError},
            {"relativeErrorInterval", {outlook.error.low, outlook.error.high}},
            {"deviceSeconds", outlook.deviceSeconds},
            {"secondsPerPixelSample", outlook.pace.seconds}};
}

}  // namespace

std::optional<FrameOutlook> outlookOf(const ConstTables& t, const FrameRow& frame, const JobSpec& spec) {
    const uint64_t pixels = uint64_t{spec.image.width} * spec.image.height;
    FrameOutlook outlook;
    outlook.tiles = tilesOf(t, frame, spec);
    const std::vector<LevelRow> levels = t.frames.levels(frame.job, frame.frame);
    const std::vector<CostPoint> curve = curveOf(levels, outlook.tiles, pixels);
    const auto last =
        std::find_if(levels.rbegin(), levels.rend(), [](const LevelRow& l) { return l.deviceSeconds; });
    if (curve.size() < kLeastPoints) return {};
    const auto pace = paceOf(curve);
    const auto error = accuracyOf(*last, spec.image);
    if (!pace || !error) return {};
    outlook.pace = *pace;
    outlook.error = *error;
    outlook.deviceSeconds = curve.back().deviceSeconds;
    if (outlook.tiles.size() < 2) outlook.tiles = {wholeOf(*last, pixels)};
    return outlook;
}

Forecast forecastOf(const FrameOutlook& frame, const StopCondition& stop) {
    std::optional<Forecast> f;
    if (stop.relativeError > 0) f = forecast(frame, passSchedule(stop.samples), stop.relativeError);
    if (!f) f = forecastSamples(frame, stop.samples);
    if (stop.deviceSeconds > 0)
        for (double* seconds : {&f->deviceSeconds, &f->low, &f->high})
            *seconds = std::min(*seconds, stop.deviceSeconds);
    return *f;
}

json keptForecast(const FrameRow& frame) {
    if (!frame.forecastAt) return nullptr;
    return {
        {"madeAtDeviceSeconds", *frame.forecastAt},
        {"deviceSeconds", secondsJson(*frame.forecastSeconds, *frame.forecastLow, *frame.forecastHigh, 1)},
        {"outcome", frame.state == FrameState::active ? json() : json(frame.deviceSeconds)}};
}

json forecastView(const ConstTables& t, const JobRow& job, const JobSpec& spec,
                  const std::vector<double>& targets, uint32_t frames) {
    const std::vector<FrameRow> begun = t.frames.list(job.key);
    const FrameRow* frame = farthest(begun);
    const auto outlook = frame ? outlookOf(t, *frame, spec) : std::nullopt;
    const Paces paces = pacesOf(t, job);
    json view{{"job", job.id},
              {"frames", frames},
              {"basis", outlook ? basisOf(*frame, *outlook) : json()},
              {"workers", paces.workers},
              {"forecast", json()},
              {"targets", json::array()}};
    if (!outlook) return view;
    const Farm farm{frames, paces.samplesPerSecond * outlook->pace.seconds};
    view["forecast"] = forecastJson(forecastOf(*outlook, spec.stop), farm);
    const auto schedule = passSchedule(kUsualMostSamples);
    for (const double target : targets) {
        json row{{"relativeError", target},
                 {"forecast", forecastJson(forecast(*outlook, schedule, target), farm)}};
        view["targets"].push_back(row);
    }
    return view;
}

}  // namespace tilefarm
