#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace tilefarm {

inline bool isFinite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool isFinite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!std::isfinite(m[c][r])) {
                return false;
            }
        }
    }
    return true;
}

/// A job's three numbers as a vector.
inline glm::dvec3 vectorOf(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

}  // namespace tilefarm
