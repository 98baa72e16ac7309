#pragma once

#include <cmath>

namespace tilefarm {

/// IEC 61966-2-1, from 0 … 1 to 0 … 1.
inline double srgbToLinear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace tilefarm
