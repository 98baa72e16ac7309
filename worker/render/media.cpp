#include "worker/render/media.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tilefarm {
namespace {

bool within(const glm::dvec3& p, const glm::dvec3& lower, const glm::dvec3& upper) {
    return glm::all(glm::greaterThanEqual(p, lower)) && glm::all(glm::lessThanEqual(p, upper));
}

/// Solid angle of a triangle seen from a point (van Oosterom, Strackee 1983), positive where its front faces
/// away.
double solidAngle(const std::array<glm::vec3, 3>& triangle, const glm::dvec3& point) {
    const glm::dvec3 a = glm::dvec3(triangle[0]) - point, b = glm::dvec3(triangle[1]) - point,
                     c = glm::dvec3(triangle[2]) - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double numerator = glm::dot(a, glm::cross(b, c));
    const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::atan2(numerator, denominator);
}

/// In the shape's own space.
bool shapeHolds(const Shape& shape, const glm::dvec3& p) {
    const glm::dvec3& size = shape.size;
    const double around = std::hypot(p.x, p.z);
    switch (shape.kind) {
        case ShapeKind::sphere: return glm::length(p) < size.x;
        case ShapeKind::box: return glm::all(glm::lessThan(glm::abs(p), size));
        case ShapeKind::cylinder:
            return std::abs(p.y) < size.x && around < size.y + (size.z - size.y) * 0.5 * (p.y / size.x + 1);
        case ShapeKind::capsule:
            return size.y == size.z && std::hypot(around, std::max(std::abs(p.y) - size.x, 0.0)) < size.y;
        default: return false;
    }
}

/// What touches may be apart by the rounding of its corners.
bool touch(const Solid& a, const Solid& b) {
    const glm::dvec3 rounding = 1e-6 * glm::max(glm::max(glm::abs(a.lower), glm::abs(a.upper)),
                                                glm::max(glm::abs(b.lower), glm::abs(b.upper)));
    return glm::all(glm::lessThanEqual(a.lower, b.upper + rounding)) &&
           glm::all(glm::lessThanEqual(b.lower, a.upper + rounding));
}

Solid solidOf(const WorldGeometry& world, const WorldInstance& instance) {
    Solid solid{instance.material, glm::dvec3(INFINITY), glm::dvec3(-INFINITY), {}, {}};
    for (uint32_t i = 0; i < instance.triangleCount; ++i) {
        const glm::uvec3 t = world.triangles[instance.firstTriangle + i];
        solid.triangles.push_back({world.positions[t.x], world.positions[t.y], world.positions[t.z]});
        for (const glm::vec3& corner : solid.triangles.back()) {
            solid.lower = glm::min(solid.lower, glm::dvec3(corner));
            solid.upper = glm::max(solid.upper, glm::dvec3(corner));
        }
    }
    return solid;
}

}  // namespace

bool Solid::holds(const glm::dvec3& point) const {
    if (!within(point, lower, upper)) return false;
    if (shape) return shapeHolds(*shape, glm::dvec3(glm::inverse(shape->toWorld) * glm::dvec4(point, 1)));
    double sum = 0;
    for (const auto& triangle : triangles) sum += solidAngle(triangle, point);
    return sum > 2 * std::numbers::pi;  // half way between 0 outside and 4π inside
}

double Solid::volumeOfBox() const {
    const glm::dvec3 extent = upper - lower;
    return extent.x * extent.y * extent.z;
}

Solids::Solids(const Scene& scene, const WorldGeometry& world) {
    for (const WorldInstance& instance : world.instances)
        if (instance.triangleCount > 0 && isSolid(world.materialOf(scene, instance.material)))
            solids_.push_back(solidOf(world, instance));
    for (const WorldShape& shape : world.shapes)
        if (isSolid(world.materialOf(scene, shape.shape.material)))
            solids_.push_back({shape.shape.material, shape.lower, shape.upper, {}, shape.shape});
    // The innermost first, for mediaAt.
    std::stable_sort(solids_.begin(), solids_.end(),
                     [](const Solid& a, const Solid& b) { return a.volumeOfBox() < b.volumeOfBox(); });
    for (size_t i = 0; i < solids_.size() && !nested_; ++i)
        nested_ = std::any_of(solids_.begin() + static_cast<std::ptrdiff_t>(i) + 1, solids_.end(),
                              [&](const Solid& other) { return touch(solids_[i], other); });
}

glm::uvec4 Solids::mediaAt(const glm::dvec3& point) const {
    glm::uvec4 media(gpu::NO_INDEX);
    int count = 0;
    for (const Solid& solid : solids_)
        if (count < 4 && solid.holds(point)) media[count++] = solid.material;
    return media;
}

uint64_t setMedia(gpu::FrameParameters& parameters, const Solids& solids, const glm::dvec3& eye) {
    parameters.cameraMedia = solids.mediaAt(eye);
    const bool needed = solids.nested() || parameters.cameraMedia.x != gpu::NO_INDEX;
    parameters.mediaNest = needed ? 1 : 0;
    // An index of refraction relative to an equal one is 1, which the code of mirrors lets through.
    return needed ? gpu::bit(gpu::FEATURE_NESTED_MEDIA) | gpu::bit(gpu::FEATURE_MIRROR) : 0;
}

}  // namespace tilefarm
