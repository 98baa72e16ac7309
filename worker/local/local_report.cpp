#include "worker/local/local_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "shared/digest/digest.h"
#include "shared/film/estimate_json.h"
#include "shared/film/notices.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

json maybe(const std::optional<double>& value) {
    return value ? json(*value) : json();
}

json sceneJson(const JobSpec& spec, const PreparedScene& scene) {
    const SceneCounts& counts = scene.counts;
    return {{"entry", spec.scene.entry},
            {"files", spec.scene.files},
            {"environment", spec.scene.environment},
            {"triangles", counts.triangles},
            {"instances", counts.instances},
            {"lights", counts.lights.lights},
            {"emissiveGroups", counts.lights.emissiveGroups},
            {"emissiveTriangles", counts.lights.emissiveTriangles},
            {"materials", counts.materials},
            {"images", counts.images},
            {"degenerateTriangles", counts.degenerateTriangles},
            {"sanitisedTexels", counts.sanitisedTexels}};
}

/// Of all samples, summed up.
double luminanceOf(const RenderedFrame& frame) {
    double sum = 0;
    for (const FilmTile& tile : frame.tiles)
        for (const FilmPixel& pixel : tile.pixels) sum += pixel.count * pixel.luminance();
    return sum;
}

// As the server's reports have it, without what the scene says.
json numericsJson(const JobSpec& spec, const RenderedFrame& frame) {
    const RenderStats& stats = frame.stats;
    json samples = json::array();
    for (const DroppedSample& s : stats.faults.dropped)
        samples.push_back({{"frame", spec.frames.first},
                           {"x", s.x},
                           {"y", s.y},
                           {"sample", s.sample},
                           {"seed", spec.settings.seed}});
    const double paths = static_cast<double>(stats.samples);
    const auto perPath = [&](double sum) { return paths > 0 ? sum / paths : 0; };
    const double removed = stats.faults.clampedLuminance, light = removed + luminanceOf(frame);
    return {{"droppedSamples", stats.droppedSamples},
            {"rejectedPaths", stats.faults.rejectedPaths},
            {"truncatedPaths", stats.faults.truncatedPaths},
            {"truncatedShare", perPath(static_cast<double>(stats.faults.truncatedPaths))},
            {"truncatedThroughput", perPath(stats.faults.truncatedThroughput)},
            {"clampedSamples", stats.faults.clampedSamples},
            {"clampedLuminance", perPath(removed)},
            {"clampedPercent", removed > 0 && light > 0 ? 100 * removed / light : 0},
            {"lightsBehindGlass", stats.faults.lightsBehindGlass},
            {"samples", samples}};
}

json warningsJson(const PreparedScene& scene) {
    json list = json::array();
    for (const SceneWarning& w : scene.warnings)
        list.push_back({{"feature", w.feature}, {"where", w.where}, {"instead", w.instead}});
    return list;
}

json curveJson(const RenderedFrame& frame) {
    json curve = json::array();
    for (const ErrorPoint& point : frame.errorCurve)
        curve.push_back({{"samples", point.samples},
                         {"relativeError", maybe(point.relativeError)},
                         {"relativeErrorInterval", intervalJson(point.estimate)},
                         {"deviceSeconds", point.deviceSeconds}});
    return curve;
}

uint32_t samplesOf(const RenderedFrame& frame) {
    return frame.errorCurve.empty() ? 0 : frame.errorCurve.back().samples;
}

double perSecond(uint64_t count, double seconds) {
    return seconds > 0 ? static_cast<double>(count) / seconds : 0;
}

}  // namespace

json localReport(const JobSpec& spec, const DeviceName& device, const PreparedScene& scene,
                 const RenderedFrame& frame) {
    const json specJson = toJson(spec);
    const RenderStats& stats = frame.stats;
    const auto accuracy = frame.errorCurve.empty() ? std::nullopt : frame.errorCurve.back().estimate;
    std::vector<std::string> notices = noticesOf(stats.faults, stats.samples);
    if (accuracy)
        for (std::string& notice : noticesOf(*accuracy)) notices.push_back(std::move(notice));
    return {
        {"version", TILEFARM_VERSION},
        {"scene", sceneJson(spec, scene)},
        {"device", device.name},
        {"driver", device.driver},
        {"image", specJson.at("image")},
        {"settings", specJson.at("settings")},
        {"environment", specJson.at("environment")},
        {"lights", specJson.at("lights")},
        {"materials", specJson.at("materials")},
        {"variant", spec.variant},
        {"camera", spec.camera},
        {"frame", spec.frames.first},
        {"features", {{"used", scene.features.used}, {"leftOut", scene.features.leftOut}}},
        {"warnings", warningsJson(scene)},
        {"prepare",
         {{"loadSeconds", scene.loadSeconds},
          {"bvhSeconds", scene.times.bvhSeconds},
          {"uploadSeconds", scene.times.uploadSeconds},
          {"pipelineSeconds", scene.times.pipelineSeconds}}},
        {"seconds", frame.seconds},
        {"deviceSeconds", stats.deviceSeconds},
        {"samples", stats.samples},
        {"rays", stats.rays},
        {"samplesPerSecond", perSecond(stats.samples, stats.deviceSeconds)},
        {"raysPerSecond", perSecond(stats.rays, stats.deviceSeconds)},
        {"droppedSamples", stats.droppedSamples},
        {"numerics", numericsJson(spec, frame)},
        {"notices", notices},
        {"samplesPerPixel", samplesOf(frame)},
        {"stopReason", toString(frame.stopReason)},
        {"stopped", sentenceOf(frame.stopReason, spec.stop, samplesOf(frame))},
        {"relativeError", frame.errorCurve.empty() ? json() : maybe(frame.errorCurve.back().relativeError)},
        {"relativeErrorInterval", intervalJson(accuracy)},
        {"errorTail", tailJson(accuracy)},
        {"errorCurve", curveJson(frame)}};
}

ImageAttributes localAttributes(const JobSpec& spec, const DeviceName& device, const RenderedFrame& frame) {
    const json specJson = toJson(spec);
    const auto& curve = frame.errorCurve;
    const bool known = !curve.empty() && curve.back().relativeError;
    return {{"job", "local"},
            {"frame", fmt::to_string(spec.frames.first)},
            {"scene", sha256Hex(specJson.at("scene").dump())},
            {"settings", specJson.dump()},
            {"samples", fmt::to_string(samplesOf(frame))},
            {"devices", device.name},
            {"drivers", device.driver},
            {"deviceSeconds", fmt::format("{:.6f}", frame.stats.deviceSeconds)},
            {"droppedSamples", fmt::to_string(frame.stats.droppedSamples)},
            {"relativeError", known ? fmt::format("{:.6f}", *curve.back().relativeError) : ""},
            {"renderer", "Tilefarm " TILEFARM_VERSION},
            {"state", "complete"},
            {"stopped", sentenceOf(frame.stopReason, spec.stop, samplesOf(frame))}};
}

}  // namespace tilefarm
