#include "gpu_light_packers.h"

#include <numbers>

namespace tilefarm {
namespace {

// Spheres that are round in the world and emit evenly. Of other shapes that emit, the BSDF finds the light.
bool isSphereLight(const Shape& shape, const Material& material) {
    return shape.kind == ShapeKind::sphere && isSimilarity(shape.toWorld) && emitsEvenly(material) &&
           material.doubleSided;
}

}  // namespace

bool addSphereShape(const EmissiveShape& emissive, LightList& lights, PackedLights& packed) {
    const auto& [shape, material, primitive] = emissive;
    if (!isSphereLight(shape, material)) return false;
    const glm::dvec3 centre(shape.toWorld[3]);
    const double radius = shape.size.x * glm::length(glm::dvec3(shape.toWorld[0]));
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_SPHERE;
    record.primitive = primitive;
    record.p = glm::vec3(centre);
    record.a.x = static_cast<float>(radius);
    record.area = static_cast<float>(4 * std::numbers::pi * radius * radius);
    LightBounds bounds;
    bounds.lower = centre - radius;
    bounds.upper = centre + radius;
    bounds.thetaO = std::numbers::pi;
    bounds.thetaE = std::numbers::pi / 2;
    const glm::vec3 emission = coveredEmission(material);
    bounds.intensity = luminance(emission) * std::numbers::pi * radius * radius;
    const uint32_t index = lights.next();
    if (!lights.add(record, emission, 4 * std::numbers::pi * bounds.intensity, bounds)) return true;
    packed.primitiveLights[primitive] = index;
    packed.features |= gpu::bit(gpu::FEATURE_SPHERE_LIGHTS);
    return true;
}

}  // namespace tilefarm
