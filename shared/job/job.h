#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace tilefarm {

/// An immutable bundle of files, each named by its SHA-256 (64 lower-case hex digits).
struct SceneBundle {
    std::string entry;                         // path of the .gltf or .glb within `files`
    std::map<std::string, std::string> files;  // relative path -> SHA-256
    std::string environment;                   // path within `files` of an .hdr or .exr, or empty
    friend bool operator==(const SceneBundle&, const SceneBundle&) = default;
};

struct ImageSpec {
    uint32_t width = 640;     // pixels
    uint32_t height = 360;    // pixels
    uint32_t tileSize = 128;  // pixels, 8 … 1024, a multiple of 8; never changes the pixels' bits
    friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

struct FrameRange {
    int32_t first = 0;
    uint32_t count = 1;
    friend bool operator==(const FrameRange&, const FrameRange&) = default;
};

/// What decides a sample's value, beside scene, frame, pixel and sample index.
struct RenderSettings {
    uint32_t seed = 0;
    uint32_t maxBounces = 8;     // surface scatterings after the camera ray; 0: emission only
    uint32_t rouletteStart = 4;  // bounces before Russian roulette; unbiased at any value
    friend bool operator==(const RenderSettings&, const RenderSettings&) = default;
};

struct StopCondition {
    uint32_t samples = 64;  // per pixel
    friend bool operator==(const StopCondition&, const StopCondition&) = default;
};

struct JobSpec {
    std::string name;
    SceneBundle scene;
    std::string camera = "auto";  // a camera or its node by name; "auto": the scene's first, else one that frames the scene
    FrameRange frames;
    ImageSpec image;
    RenderSettings settings;
    StopCondition stop;
    int32_t priority = 50;  // 0 … 100, higher first
    friend bool operator==(const JobSpec&, const JobSpec&) = default;
};

}  // namespace tilefarm
