#pragma once

#include <filesystem>
#include <string>

#include "worker/scene/scene.h"

namespace tilefarm {

/// Loads a .gltf (embedded or with files beside it) or .glb, at rest (gltf_source.h: over time) and in its
/// default scene. Throws Error(invalidArgument) that names the file, the JSON place and the fault; every
/// index, offset and count is checked before use. An unknown extension in extensionsRequired is an
/// error, one in extensionsUsed a warning. `variant` is one of KHR_materials_variants by name; empty:
/// the file's default materials.
Scene loadGltf(const std::filesystem::path& path, const std::string& variant = {});

/// Loads a picture of all directions: equirectangular .hdr, .exr, .png or .jpg, or an .exr that is a cube
/// map. Channels below 0 become 0, infinite ones the largest finite value, texels with one that is not a
/// number black; of that and of what else the file holds and is not used `scene.warnings` tell. Throws
/// Error(invalidArgument) that names the file and the fault; if `strict` also of what other readers take
/// though its format does not know it.
void loadEnvironment(Scene& scene, const std::filesystem::path& path, bool strict = false);

/// Surrounds a scene that nothing lights with white light of radiance 1 and says so in `scene.warnings`: a
/// black image helps nobody. An environment is light whatever it shows; a lamp of intensity 0, a surface
/// that is unlit, emits black or has no alpha or area is none. A scene of unlit surfaces alone needs none.
/// Call after loadEnvironment, with the textures decoded.
void lightIfDark(Scene& scene);

/// The same radiance from everywhere.
Environment constantEnvironment(const glm::vec3& color);

/// The camera that a job names: by camera or node name; "auto" is the scene's first camera, or
/// framingCamera where it has none. Throws Error(invalidArgument) that lists the names there are.
Camera selectCamera(const Scene& scene, const std::string& name, double imageAspect);

/// The middle of the box around the scene's meshes and shapes.
glm::dvec3 middleOf(const Scene& scene);

/// Sees the whole scene from the front, a little from above and from the side, with a vertical field of
/// view of 40°.
Camera framingCamera(const Scene& scene, double imageAspect);

}  // namespace tilefarm
