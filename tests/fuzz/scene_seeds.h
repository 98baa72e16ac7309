#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace tilefarm {

/// Small whole files by name, that have between them everything the loader knows.
std::vector<std::pair<std::string, GltfBuilder>> sceneSeeds();

/// Writes them all, embedded and as GLB by turns; gives their paths.
std::vector<std::filesystem::path> writeSceneSeeds(const std::filesystem::path& folder);

}  // namespace tilefarm
