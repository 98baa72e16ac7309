#pragma once

// Part of the table in fields.h: what a frame holds beyond its picture.

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
            "channels of light by its first scattering: emission, and diffuse, specular, transmission and "
            "volume, each direct and indirect; they add up to the picture"},
           output.lightPaths);
    v.flag({"uv", "a channel of the first surface's texture coordinates"}, output.uv);
    v.flag({"cryptomatte", "ids of objects and materials with their coverage (Cryptomatte 1.2)"},
           output.cryptomatte);
    v.choice({"cryptomatteManifest",
              "where the names that the ids stand for are: in the file's header, in sidecar files beside it, "
              "or in sidecar files where they are longer than 250 bytes (auto)"},
             output.cryptomatteManifest, kMatteManifestChoices);
    v.flag(
        {"denoise",
         "channels of the picture without its noise, when the frame is complete; biased, so beside the raw "
         "picture and never instead of it"},
        output.denoise);
}

}  // namespace tilefarm
