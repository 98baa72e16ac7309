#include "gpu_light_packers.h"
#include "worker/render/lights/light_kinds.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace tilefarm {
namespace {

// Sides at right angles, as the sampling of its solid angle needs them.
bool isQuadLight(const Shape& shape, const Material& material) {
    const glm::dvec3 u(shape.toWorld[0]), v(shape.toWorld[1]);
    return shape.kind == ShapeKind::rectangle && emitsEvenly(material) &&
           std::abs(glm::dot(u, v)) <= 1e-6 * glm::length(u) * glm::length(v);
}

QuadLight quadOf(const Shape& shape, const Material& material) {
    glm::dvec3 u = shape.size.x * glm::dvec3(shape.toWorld[0]),
               v = shape.size.y * glm::dvec3(shape.toWorld[1]);
    // A mirror image keeps its front.
    if (glm::determinant(glm::dmat3(shape.toWorld)) < 0) std::swap(u, v);
    QuadLight quad;
    quad.corner = glm::dvec3(shape.toWorld[3]) - u - v;
    quad.a = 2.0 * u;
    quad.b = 2.0 * v;
    quad.radiance = coveredEmission(material);
    quad.twoSided = material.doubleSided;
    return quad;
}

}  // namespace

bool addQuad(const QuadLight& quad, LightList& lights, PackedLights& packed) {
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_QUAD;
    record.primitive = quad.twoSided ? 1 : 0;
    record.p = quad.corner;
    record.a = quad.a;
    record.b = quad.b;
    const glm::dvec3 normal = glm::cross(glm::dvec3(quad.a), glm::dvec3(quad.b));
    record.area = static_cast<float>(glm::length(normal));
    const double intensity = luminance(quad.radiance) * glm::length(normal);
    if (!lights.add(record, quad.radiance, std::numbers::pi * intensity * (quad.twoSided ? 2 : 1),
                    flatBounds({quad.corner, quad.corner + quad.a, quad.corner + quad.b,
                                quad.corner + quad.a + quad.b},
                               normal, intensity, quad.twoSided)))
        return false;
    packed.features |= gpu::bit(gpu::FEATURE_QUAD_LIGHTS);
    return true;
}

bool addQuadShape(const EmissiveShape& emissive, LightList& lights, PackedLights& packed) {
    if (!isQuadLight(emissive.shape, emissive.material)) return false;
    const uint32_t index = lights.next();
    if (addQuad(quadOf(emissive.shape, emissive.material), lights, packed))
        packed.primitiveLights[emissive.primitive] = index;
    return true;
}

}  // namespace tilefarm
