#pragma once

// Part of the table in fields.h: the additional channels of a frame.

#include "shared/job/lighting_fields.h"
#include "shared/job/output.h"

namespace tilefarm {

inline constexpr std::array kMatteManifestChoices{
    Choice<MatteManifest>{"auto", MatteManifest::automatic},
    Choice<MatteManifest>{"header", MatteManifest::header},
    Choice<MatteManifest>{"sidecar", MatteManifest::sidecar},
};

template <typename Visitor>
void describe(Visitor& v, Is<OutputSettings> auto& output) {
    v.flag({"lightPaths",
            "light path channels by the first scattering event: emission, and diffuse, specular, "
            "transmission and volume, each direct and indirect; they add up to the picture"},
           output.lightPaths);
    v.flag({"uv", "texture coordinates (TEXCOORD_0) of the first surface"}, output.uv);
    v.flag({"cryptomatte", "ID mattes of objects and materials (Cryptomatte 1.2)"}, output.cryptomatte);
    v.choice({"cryptomatteManifest",
              "where Cryptomatte's manifest is stored: in the EXR's header (header), in JSON files beside it "
              "(sidecar), or beside it only if longer than 250 bytes (auto)"},
             output.cryptomatteManifest, kMatteManifestChoices);
    v.flag({"denoise",
            "adds a denoised picture as channels denoised.R, .G and .B when the frame is complete; biased, "
            "so the raw picture stays"},
           output.denoise);
}

}  // namespace tilefarm
