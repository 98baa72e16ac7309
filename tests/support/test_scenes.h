#pragma once

#include "worker/scene/scene.h"

/// Small scenes as plain values, for tests that know their image in closed form.
namespace tilefarm {

/// A material that reflects `albedo` like Lambert and nothing else (index of refraction 1).
Material matte(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0));

/// Adds a mesh under an instance of its own with a material of its own.
void addMesh(Scene& scene, Mesh mesh, const Material& material, const glm::dmat4& toWorld = glm::dmat4(1));

/// The parallelogram p, p + a, p + a + b, p + b; its front is the side that a × b points to.
Mesh quadMesh(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b);
/// An axis-parallel cube of side 2 around the origin. Its front is outside, or inside if `inwards`.
Mesh cubeMesh(bool inwards);
/// A sphere of radius 1 of 2·segments × segments quads with smooth normals.
Mesh sphereMesh(int segments);

/// The same radiance from everywhere.
Environment uniformEnvironment(const glm::vec3& radiance, uint32_t width = 8, uint32_t height = 4);

/// At `eye`, looking at `target`.
Camera cameraAt(const glm::dvec3& eye, const glm::dvec3& target, double yfov);

}  // namespace tilefarm
