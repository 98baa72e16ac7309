#pragma once

#include <map>

#include "shared/error/error.h"
#include "worker/scene/accessors.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// What the parts of the glTF loader share while one file is loaded.
struct LoadContext {
    const GltfFile& file;
    BufferViews& views;
    Accessors& accessors;
    Scene& scene;
    uint32_t variant = kNone;  // of KHR_materials_variants
    double lightUnit = 1;      // W/sr or W/m² of an intensity of 1 in KHR_lights_punctual
    std::map<uint32_t, Error> brokenMaterials = {};  // which stand in the scene as a default one

    /// Throws the fault of a material that is to be rendered.
    void requireMaterial(uint32_t material) const;

    /// Notes what is rendered otherwise, once for each feature and place.
    void warn(const std::string& feature, const JsonNode& where, const std::string& instead);
};

}  // namespace tilefarm
