#pragma once

#include <array>
#include <optional>

#include "shared/job/color.h"

namespace tilefarm {

/// Fog: a homogeneous medium that absorbs and scatters, outside of solids, within a box that is parallel to
/// the axes. Beyond the box light is as without fog, so an environment shows through.
struct FogSettings {
    Color extinction{0, 0, 0};  // 1/m, share of light that is absorbed or scattered on a short way; 0: no fog
    Color albedo{1, 1, 1};      // share of that which is scattered
    double anisotropy = 0;      // mean cosine g of the scattering angle (Henyey, Greenstein)
    // m, both or neither; neither: the box around all surfaces and the camera
    std::optional<std::array<double, 3>> min, max;
    friend bool operator==(const FogSettings&, const FogSettings&) = default;
};

}  // namespace tilefarm
