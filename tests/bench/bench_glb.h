#pragma once

#include <filesystem>

#include "worker/scene/scene.h"

namespace tilefarm::bench {

/// Writes geometry, colours, emission and cameras of `scene` as a .glb, for programs that cannot be handed a
/// Scene. Textures and punctual lights are left out. Throws Error(internal) that names the file.
void writeGlb(const Scene& scene, const std::filesystem::path& path);

}  // namespace tilefarm::bench
