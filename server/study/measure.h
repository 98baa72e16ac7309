#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>

#include "server/study/statistics.h"

namespace tilefarm {

/// {"value", "low", "high"}, or null.
nlohmann::json toJson(const std::optional<Estimate>& estimate);

struct MeasuredCell {
    nlohmann::json result;    // means over seeds with their intervals, and what each seed gave
    nlohmann::json pictures;  // of the first seed: "picture" and "difference", as data URLs
};

/// Compares the pictures of a variant with the reference, one seed in memory at a time. All squared errors
/// are relative, as relMSE is: each value's is divided by r² + 0.01². `seconds`: device seconds of each
/// seed's job; `picture` gives its picture at the reference's size.
MeasuredCell measureCell(const FloatImage& reference, std::span<const double> seconds,
                         const std::function<FloatImage(size_t seed)>& picture);

}  // namespace tilefarm
