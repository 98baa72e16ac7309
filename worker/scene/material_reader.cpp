#include "worker/scene/material_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace tilefarm {

float MaterialReader::clampedValue(const JsonNode& value, double given, double lower, double upper) {
    const double result = std::clamp(given, lower, upper);
    if (result != given) {
        load_.warn(value.place().substr(value.place().rfind('/') + 1), node_,
                   fmt::format("{} is out of range, rendered with {}", given, result));
    }
    return static_cast<float>(result);
}

float MaterialReader::clamped(const JsonNode& value, double fallback, double lower, double upper) {
    return clampedValue(value, value.numberOr(fallback), lower, upper);
}

glm::vec3 MaterialReader::color(const JsonNode& value, glm::vec3 fallback, double upper) {
    if (!value) {
        return fallback;
    }
    const std::vector<double> v = value.numbers(3);
    return {clampedValue(value, v[0], 0, upper), clampedValue(value, v[1], 0, upper),
            clampedValue(value, v[2], 0, upper)};
}

glm::vec4 MaterialReader::colorAndAlpha(const JsonNode& value) {
    if (!value) {
        return glm::vec4(1);
    }
    const std::vector<double> v = value.numbers(4);
    return {clampedValue(value, v[0], 0, 1), clampedValue(value, v[1], 0, 1), clampedValue(value, v[2], 0, 1),
            clampedValue(value, v[3], 0, 1)};
}

}  // namespace tilefarm
