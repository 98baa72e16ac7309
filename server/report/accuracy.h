#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "server/store/job_store.h"
#include "shared/film/error_sums.h"
#include "shared/job/image_spec.h"

namespace tilefarm {

/// Of a complete level of a frame of that size; nothing where it is unknown: at one sample, and of levels
/// that a version before intervals measured.
std::optional<ErrorEstimate> accuracyOf(const LevelRow& level, const ImageSpec& image);

/// Adds stopReason and, for people, stopped: why all of the frame is merged; null while it is not.
void addStop(nlohmann::json& view, const FrameRow& frame, const StopCondition& stop);

/// Adds relativeErrorInterval and errorTail of the frame's last complete level, which it gives back, and
/// errorCurve: the first complete level at or after each power of two and the last, for a job of a million
/// samples has thousands.
std::optional<ErrorEstimate> addAccuracy(nlohmann::json& view, const ConstTables& t, JobKey job,
                                         int32_t frame, const ImageSpec& image);

}  // namespace tilefarm
