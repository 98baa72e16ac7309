#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "shared/job/appearance.h"
#include "shared/job/lighting.h"
#include "worker/scene/scene.h"

namespace tilefarm {

struct GltfOptions {
    std::string variant = {};       // of KHR_materials_variants by name; empty: the file's default materials
    std::string animation = "all";  // plays: "all", "none", or one by name
    bool loop = false;              // each animation starts again at its end, else it stays there
    bool strict = false;            // faults that are tolerated, or of what is not used, stop the load
    size_t levelsUp = 0;            // above the file's folder that its references may lead
    Microfacets microfacets = Microfacets::ggx;    // of materials that do not say theirs
    Fresnel fresnel = Fresnel::exact;              // likewise
    LightUnits lightUnits = LightUnits::radiometric;  // of KHR_lights_punctual
    std::vector<MaterialOverride> materials = {};  // laid over those of the file, also over animated ones
};

/// A glTF file and the scene it shows at any time. Images are decoded and meshes that do not change shape
/// are read once. Throws as loadGltf does (load.h).
class GltfSource {
public:
    GltfSource(const std::filesystem::path& path, GltfOptions options);
    ~GltfSource();

    /// Whether the scene differs between times. A file that is not animated always shows the same.
    bool animated() const;
    /// Whether more than cameras differs.
    bool moves() const;
    /// Of the longest animation, from time 0 to its last key; 0 if none plays.
    double seconds() const;
    /// The scene at a time in seconds, good until the next call; a pure function of the time but for the
    /// places of meshes in its list. Its environment and its warnings are kept from call to call.
    Scene& at(double seconds);
    /// The scene as at(0), for good.
    Scene take();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
