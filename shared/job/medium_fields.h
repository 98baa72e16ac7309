#pragma once

// Part of the table in fields.h: what lies between the surfaces.

#include "shared/job/lighting_fields.h"
#include "shared/job/medium.h"

namespace tilefarm {

inline constexpr NumberRange kExtinction{0, 1e9};
inline constexpr NumberRange kAnisotropy{-0.9999, 0.9999};

template <typename Visitor>
void describe(Visitor& v, Is<FogSettings> auto& fog) {
    v.triple({"extinction", "extinction coefficient in 1/m, by channel; 0 is no fog"}, fog.extinction,
             kExtinction);
    v.triple({"albedo", "share of the extinction that is scattered"}, fog.albedo, kShare);
    v.number({"anisotropy", "mean cosine g of the scattering angle: above 0 forwards, below 0 backwards"},
             fog.anisotropy, kAnisotropy);
    v.triple({"min", "m, corner of the box that it fills; without: around all surfaces and the camera"},
             fog.min, kCoordinate);
    v.triple({"max", "m, the opposite corner"}, fog.max, kCoordinate);
}

}  // namespace tilefarm
