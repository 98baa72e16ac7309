#include "server/report/accuracy.h"

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/film/estimate_json.h"

namespace tilefarm {

using nlohmann::json;

std::optional<ErrorEstimate> accuracyOf(const LevelRow& level, const ImageSpec& image) {
    const bool measured = level.errorSquares > 0 || level.relativeVariance == 0;
    if (!level.relativeError || !measured) return {};
    const ErrorSums sums{.relativeVariance = level.relativeVariance,
                         .squares = level.errorSquares,
                         .borrowed = level.borrowedVariance,
                         .pixels = uint64_t{image.width} * image.height,
                         .droppedSamples = level.droppedSamples,
                         .tail = level.errorTail};
    return sums.estimate();
}

void addStop(json& view, const FrameRow& frame, const StopCondition& stop) {
    view["stopReason"] = frame.stopReason ? json(toString(*frame.stopReason)) : json();
    view["stopped"] = frame.stopReason ? json(stopSentence(frame, stop)) : json();
}

std::optional<ErrorEstimate> addAccuracy(json& view, const ConstTables& t, JobKey job, int32_t frame,
                                         const ImageSpec& image) {
    const std::vector<LevelRow> levels =
        t.frames.levels(job, frame);  // by samples; they complete in that order
    const auto last =
        std::find_if(levels.rbegin(), levels.rend(), [](const auto& l) { return l.deviceSeconds; });
    json curve = json::array();
    uint32_t before = 0;
    for (const LevelRow& level : levels) {
        if (!level.deviceSeconds) continue;
        const bool newOctave =
            std::bit_width(level.samples) > std::bit_width(std::exchange(before, level.samples));
        if (!newOctave && level.samples != last->samples) continue;
        curve.push_back({{"samples", level.samples},
                         {"relativeError", level.relativeError ? json(*level.relativeError) : json()},
                         {"relativeErrorInterval", intervalJson(accuracyOf(level, image))},
                         {"deviceSeconds", *level.deviceSeconds}});
    }
    const auto accuracy = last == levels.rend() ? std::nullopt : accuracyOf(*last, image);
    view["relativeErrorInterval"] = intervalJson(accuracy);
    view["errorTail"] = tailJson(accuracy);
    view["errorCurve"] = curve;
    return accuracy;
}

}  // namespace tilefarm
