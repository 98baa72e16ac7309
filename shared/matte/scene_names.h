#pragma once

#include <set>
#include <string>

#include "shared/gltf/gltf_bytes.h"
#include "shared/matte/cryptomatte.h"

namespace tilefarm {

struct JobSpec;

/// What the ids of a scene's mattes may stand for.
struct SceneNames {
    std::set<std::string> objects, materials;
};

/// The name by which a node or material without one goes: "nodes/3", "materials/2".
std::string nodeName(size_t index);
std::string materialName(const std::string& name, size_t index);
/// An area light that a job adds without a name.
std::string lightName(const std::string& name);
/// The material of every area light.
inline constexpr const char* kLightMaterialName = "light";
/// The material of primitives that have none.
inline constexpr const char* kDefaultMaterialName = "default";

/// Names of all nodes, lights and materials of a glTF file, whether they are seen or not, and of the lights
/// that the job adds. Of things that share a name the ids are one. Throws Error(invalidArgument) if it is no
/// glTF.
SceneNames sceneNames(const GltfBytes& gltf, const JobSpec& job);

/// Of the mattes that the job asks for; nothing if it asks for none. Manifests are empty where the scene's
/// file cannot be read: ids are then ids still.
MatteMetadata matteMetadata(const GltfBytes& gltf, const JobSpec& job);

}  // namespace tilefarm
