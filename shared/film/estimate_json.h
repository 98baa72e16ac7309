#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "shared/film/error_sums.h"

namespace tilefarm {

/// [low, high] of the 95 % interval, or null where the error is unknown.
nlohmann::json intervalJson(const std::optional<ErrorEstimate>& estimate);

/// What few pixels hold of the squared error: worstShare (of the worst 0.1 %) and pixels, each with x, y and
/// share, or null where the error is unknown.
nlohmann::json tailJson(const std::optional<ErrorEstimate>& estimate);

}  // namespace tilefarm
