#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shared/job/appearance.h"
#include "shared/job/frames.h"
#include "shared/job/image_spec.h"
#include "shared/job/lighting.h"
#include "shared/job/medium.h"
#include "shared/job/output.h"
#include "shared/job/render_settings.h"
#include "shared/job/viewing.h"

namespace tilefarm {

/// An immutable bundle of files, each named by its SHA-256 (64 lower-case hex digits).
struct SceneBundle {
    std::string entry;                         // path of the .gltf or .glb within `files`
    std::map<std::string, std::string> files;  // relative path -> SHA-256
    std::string environment;                   // path within `files` of the environment, or empty
    friend bool operator==(const SceneBundle&, const SceneBundle&) = default;
};

/// A frame is complete at whichever of these comes first; 0 is none. They are looked at between pass levels,
/// so that every picture is one of a sequence that the job fixes.
struct StopCondition {
    uint32_t samples = 0;      // most per pixel; 0: open until jobFromJson settles it
    double relativeError = 0;  // of the frame, as estimated
    uint32_t minSamples = 16;  // that every pixel gets before an estimate of the error counts
    double deviceSeconds = 0, wallSeconds = 0;  // of the frame

    bool hasTimeLimit() const { return deviceSeconds > 0 || wallSeconds > 0; }
    /// Whether it depends on what is merged so far which passes are rendered next.
    bool decidesOnTheWay() const { return relativeError > 0 || hasTimeLimit(); }
    friend bool operator==(const StopCondition&, const StopCondition&) = default;
};
/// Of a job that does not say how many: alone, and beside another condition.
inline constexpr uint32_t kUsualSamples = 64, kUsualMostSamples = 65536;

struct JobSpec {
    std::string name;
    SceneBundle scene;
    std::string camera =
        "auto";  // a camera or its node by name; "auto": the scene's first, else one that frames the scene
    FrameSet frames;
    ImageSpec image;
    RenderSettings settings;
    EnvironmentSettings environment;
    std::vector<LightSettings> lights;  // added to the scene's
    FogSettings fog;
    std::vector<MaterialOverride> materials;  // later ones win
    std::string variant;  // of KHR_materials_variants; empty: the file's default materials
    bool strict = false;  // what is invalid glTF though every other reader takes it fails the job
    ViewSettings view;
    MotionSettings motion;
    OutputSettings output;
    StopCondition stop;
    int32_t priority = 50;  // 0 … 100, higher first
    friend bool operator==(const JobSpec&, const JobSpec&) = default;
};

}  // namespace tilefarm
