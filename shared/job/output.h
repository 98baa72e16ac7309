#pragma once

namespace tilefarm {

/// Where the names of mattes are: in the header, in files beside the picture (the specification's
/// manif_file), or in files only where they are too long for the headers that ffmpeg 5.1 reads.
enum class MatteManifest { automatic, header, sidecar };

/// What a frame's EXR holds beyond the picture, its variance, and albedo, normal and depth. Nothing of it
/// changes a bit of those.
struct OutputSettings {
    bool lightPaths = false;   // the picture split by how light was first scattered
    bool uv = false;           // texture coordinates of the first surface
    bool cryptomatte = false;  // object and material ids with coverage, Cryptomatte 1.2
    MatteManifest cryptomatteManifest = MatteManifest::automatic;
    bool denoise = false;  // channels of the picture without its noise; biased, so beside the raw ones
    friend bool operator==(const OutputSettings&, const OutputSettings&) = default;
};

}  // namespace tilefarm
