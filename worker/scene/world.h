#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "worker/scene/scene.h"

/// All instances of a scene as triangles, and its shapes, in one space, ready to be packed for a device.
///
/// Transforms are composed and applied in double, a common centre is subtracted in double, and only
/// then are positions rounded to float, once: a scene far from its origin keeps all its bits.
namespace tilefarm {

/// The part of the arrays that one Scene::Instance became; same index as in the scene. Rectangular area
/// lights follow, with mesh kNone: two triangles cost a kernel less than a shape does.
struct WorldInstance {
    uint32_t mesh = 0, material = 0;
    uint32_t firstTriangle = 0, triangleCount = 0;
    uint32_t firstVertex = 0, vertexCount = 0;
    bool mirrored = false;  // negative determinant; winding and handedness have been flipped
};

struct EmissiveTriangle {
    uint32_t triangle = 0;
    double area = 0;  // in world space, of the rounded corners, m²
};

/// A surface that is not made of triangles, from Scene::shapes or Scene::areaLights.
struct WorldShape {
    Shape shape;  // re-centred
    /// The box around it, rounded outwards and by what rays that graze it may be off.
    glm::vec3 lower{0}, upper{0};
    uint32_t areaLight = kNone;  // index into Scene::areaLights of the light that it is the surface of
};

/// A rectangle that emits, beside its two triangles.
struct QuadLight {
    uint32_t firstTriangle = 0;
    glm::vec3 corner{0}, a{0}, b{0};  // re-centred; edges at right angles, it emits towards a × b
    glm::vec3 radiance{0};
    bool twoSided = false;
};

/// What a solid material is on surfaces that enclose nothing.
struct ThinMaterial {
    uint32_t of = 0;  // index into Scene::materials
    Material material;
};

struct WorldGeometry {
    /// World space is this space plus `centre`, a multiple of a power of two near the middle of the
    /// bounds; zero for a scene around its origin.
    glm::dvec3 centre{0};
    glm::vec3 lower{0}, upper{0};  // bounds of all surfaces, re-centred; equal where there are none

    std::vector<WorldInstance> instances;

    // Per vertex. Vertices of an instance follow each other in the order of their mesh.
    std::vector<glm::vec3> positions;
    // Empty where no mesh has them, else as long as positions.
    std::vector<glm::vec3> normals;   // unit length, or zero: use the geometric normal
    std::vector<glm::vec4> tangents;  // unit length, orthogonal to the normal; w: handedness, 0 for none
    std::vector<glm::vec2> uv0, uv1;  // zero where a mesh has none
    std::vector<glm::vec4> colors;    // one where a mesh has none

    // Per triangle. Corners are counter-clockwise seen from the front, also in mirrored instances.
    std::vector<glm::uvec3> triangles;  // indices into the vertices
    std::vector<uint32_t> triangleInstance;
    std::vector<uint32_t> triangleInMesh;  // index into Mesh::triangles

    /// Their primitive indices follow those of the triangles. Spherical area lights come last, with materials
    /// of their own.
    std::vector<WorldShape> shapes;
    /// Black and emitting, one per area light; index Scene::materials.size() and on.
    std::vector<Material> lightMaterials;
    /// Behind them.
    std::vector<ThinMaterial> thinMaterials;

    std::vector<EmissiveTriangle> emissive;  // those whose material has emission, by triangle
    std::vector<PunctualLight> lights;       // positions re-centred
    std::vector<QuadLight> quads;
    /// Left out here because their transform collapses them or they do not fit a float.
    uint64_t degenerateTriangles = 0, degenerateShapes = 0;

    uint32_t triangleCount() const { return static_cast<uint32_t>(triangles.size()); }
    uint32_t primitiveCount() const { return triangleCount() + static_cast<uint32_t>(shapes.size()); }
    const WorldInstance& instanceOf(uint32_t triangle) const { return instances[triangleInstance[triangle]]; }
    /// Of an instance or a shape.
    const Material& materialOf(const Scene& scene, uint32_t material) const {
        const size_t own = scene.materials.size(), thin = own + lightMaterials.size();
        if (material >= thin) return thinMaterials[material - thin].material;
        return material < own ? scene.materials[material] : lightMaterials[material - own];
    }
    size_t materialCount(const Scene& scene) const {
        return scene.materials.size() + lightMaterials.size() + thinMaterials.size();
    }
    /// Three positions per triangle, as buildBvh takes them.
    std::vector<glm::vec3> corners() const;
    /// The camera in the space of this geometry; its position is moved in double.
    Camera recentred(const Camera& camera) const;
};

/// Throws Error(invalidArgument) if there are more triangles or vertices than 32-bit indices can name.
WorldGeometry flatten(const Scene& scene);

}  // namespace tilefarm
