#pragma once

namespace tilefarm {

/// What a frame's EXR holds beyond the picture, its variance, and albedo, normal and depth. Nothing of it
/// changes a bit of those.
struct OutputSettings {
    bool lightPaths = false;   // the picture split by how light was first scattered
    bool uv = false;           // texture coordinates of the first surface
    bool cryptomatte = false;  // object and material ids with coverage, Cryptomatte 1.2
    bool denoise = false;      // channels of the picture without its noise; biased, so beside the raw ones
    friend bool operator==(const OutputSettings&, const OutputSettings&) = default;
};

}  // namespace tilefarm
