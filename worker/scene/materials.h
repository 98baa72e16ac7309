#pragma once

#include "worker/scene/gltf_source.h"
#include "worker/scene/textures.h"

namespace tilefarm {

/// Every material of the file, followed by glTF's default material for primitives that name none.
/// Factors outside of their range are clamped with a warning. References name the file's images.
std::vector<Material> parseMaterials(LoadContext& load, Textures& textures, const GltfOptions& options);

}  // namespace tilefarm
