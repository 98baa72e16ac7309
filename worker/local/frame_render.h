#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "shared/clock/clock.h"
#include "shared/film/error_sums.h"
#include "shared/film/film.h"
#include "shared/film/sample_plan.h"
#include "worker/agent/render_backend.h"

namespace tilefarm {

/// Accuracy of a frame and what it has cost so far.
struct ErrorPoint {
    uint32_t samples = 0;                 // per pixel; the mean where tiles differ
    std::optional<double> relativeError;  // none after a single sample
    double deviceSeconds = 0;
    std::optional<ErrorEstimate> estimate{};  // of relativeError
};

struct FrameProgress {
    uint64_t samplesDone = 0, samplesInAll = 0;  // pixel samples; in all: as far as can be foreseen
    ErrorPoint last;                             // of the last whole level
    double seconds = 0, secondsLeft = 0;         // of wall time; left: by the pace so far
    bool wholeLevel = false;
};

struct RenderedFrame {
    std::vector<FilmTile> tiles;  // in the order of the TileGrid
    std::vector<ErrorPoint> errorCurve;
    StopReason stopReason = StopReason::samples;
    RenderStats stats;
    double seconds = 0;  // of wall time
};

/// Renders one frame as the farm does: the passes of the schedule level by level over all tiles, then of
/// those tiles that the same decisions at the same fixed points promote, merged in sample order in double; so
/// the pixels are those of the farm bit for bit (but for time limits). The scene of `spec` is resident in
/// `backend`. `onProgress` is called after every call of the device.
RenderedFrame renderFrame(RenderBackend& backend, const JobSpec& spec, int32_t frame, const Clock& clock,
                          const std::function<void(const FrameProgress&)>& onProgress);

}  // namespace tilefarm
