#pragma once

// Part of the table in fields.h: the participating medium between the surfaces.

#include "shared/job/lighting_fields.h"
#include "shared/job/medium.h"

namespace tilefarm {

inline constexpr NumberRange kExtinction{0, 1e9};
inline constexpr NumberRange kAnisotropy{-0.9999, 0.9999};

template <typename Visitor>
void describe(Visitor& v, Is<FogSettings> auto& fog) {
    v.triple(
        {"extinction", "extinction coefficient (absorption + scattering) of each channel, 1/m; 0 is no fog"},
        fog.extinction, kExtinction);
    v.triple({"albedo", "single-scattering albedo of each channel: scattering / extinction"}, fog.albedo,
             kShare);
    v.number(
        {"anisotropy",
         "asymmetry g of the Henyey-Greenstein phase function: above 0 forward, below 0 backward scattering"},
        fog.anisotropy, kAnisotropy);
    v.triple({"min",
              "lower corner of the box that the fog fills, m; if not given: a box around all surfaces and "
              "the camera"},
             fog.min, kCoordinate);
    v.triple({"max", "upper corner of that box, m"}, fog.max, kCoordinate);
}

}  // namespace tilefarm
