#pragma once

#include "worker/scene/meshes.h"
#include "worker/scene/skins.h"

namespace tilefarm {

/// Walks the default scene (else the first, else all root nodes) and adds its instances, cameras and lights
/// to load.scene, with transforms composed in double. A node with two parents or in a cycle is an error.
void loadNodes(LoadContext& load, Meshes& meshes, const PartList<Skin>& skins);

}  // namespace tilefarm
