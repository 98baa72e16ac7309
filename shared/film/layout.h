#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tilefarm {

struct JobSpec;

/// Ids that a pixel keeps of each kind of matte.
inline constexpr uint32_t kMatteRanks = 6;
/// Layers of Cryptomatte, by what their ids name.
inline constexpr std::array<std::string_view, 2> kMattes{"CryptoObject", "CryptoMaterial"};

/// What a film has for each pixel beyond PassPixel. It follows from the job alone, so worker and server
/// agree. A pixel's extra floats are means over its samples first, then for each of kMattes `kMatteRanks`
/// pairs of an id and the number of samples that saw it, the first free pair with id and count 0.
struct FilmLayout {
    bool lightPaths = false;
    bool uv = false;
    bool cryptomatte = false;

    uint32_t means() const { return (lightPaths ? 3 * kLightPaths : 0) + (uv ? 2 : 0); }
    uint32_t pairs() const { return cryptomatte ? kMatteRanks * static_cast<uint32_t>(kMattes.size()) : 0; }
    uint32_t floats() const { return means() + 2 * pairs(); }
    /// EXR channels of the floats in their order, each of a layer without dots (Blender takes what stands
    /// before the last for a layer of its own): "diffuse_direct.R", "uv.U", "CryptoObject00.R", ….
    std::vector<std::string> channels() const;
    /// For errors: "lightPaths, uv", or "none".
    std::string text() const;
    /// Every layout that there can be.
    static std::vector<FilmLayout> all();
    friend bool operator==(const FilmLayout&, const FilmLayout&) = default;

    /// Ways of light to the camera, in the order of LIGHT_PATH_* in gpu_types.h.
    static constexpr uint32_t kLightPaths = 9;
};

FilmLayout filmLayoutOf(const JobSpec& spec);

}  // namespace tilefarm
