#include "worker/render/lights/light_kinds.h"

#include <numbers>

#include "worker/render/texture_average.h"

namespace tilefarm {
namespace {

// What the triangles of one mesh at one node have in common; instances that no node places are alone.
uint64_t objectOf(const Scene& scene, const WorldGeometry& world, uint32_t triangle) {
    const uint32_t instance = world.triangleInstance[triangle];
    const bool placed = instance < scene.instances.size() && scene.instances[instance].nodeIndex != kNone;
    return placed ? scene.instances[instance].nodeIndex : uint64_t{kNone} + 1 + instance;
}

}  // namespace

void addTriangle(const Scene& scene, const WorldGeometry& world, const EmissiveTriangle& triangle,
                 LightList& lights, PackedLights& packed) {
    const Material& material = world.materialOf(scene, world.instanceOf(triangle.triangle).material);
    if (material.unlit) return;
    const glm::uvec3 corners = world.triangles[triangle.triangle];
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_TRIANGLE;
    record.primitive = triangle.triangle;
    record.area = static_cast<float>(triangle.area);
    record.p = world.positions[corners.x];
    record.a = world.positions[corners.y] - record.p;
    record.b = world.positions[corners.z] - record.p;
    const double intensity = luminance(glm::dvec3(material.emission) *
                                       averageEmission(scene, material, world, triangle.triangle)) *
                             triangle.area;
    const glm::dvec3 normal = glm::cross(glm::dvec3(record.a), glm::dvec3(record.b));
    const uint32_t index = lights.next();
    if (lights.add(record, material.emission, std::numbers::pi * intensity * (material.doubleSided ? 2 : 1),
                   flatBounds({record.p, world.positions[corners.y], world.positions[corners.z]}, normal,
                              intensity, material.doubleSided),
                   objectOf(scene, world, triangle.triangle)))
        packed.primitiveLights[triangle.triangle] = index;
    else
        ++packed.darkTriangles;
}

}  // namespace tilefarm
