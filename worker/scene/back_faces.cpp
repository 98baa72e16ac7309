#include "worker/scene/back_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace tilefarm {
namespace {

/// Beyond so many triangles it costs more to find out than a kernel pays that asks at every hit.
constexpr size_t kMostFacets = 1 << 17;

bool isCullable(const Scene& scene, uint32_t material) {
    if (material >= scene.materials.size()) return false;
    const Material& m = scene.materials[material];
    return !m.doubleSided && m.thickness == 0;
}

/// Every edge is run along once each way, and the enclosed volume is positive: all backs are inside. Corners
/// at exactly the same place are one.
bool isClosedOutwards(const Mesh& mesh) {
    if (mesh.triangles.size() > kMostFacets) return false;
    std::map<std::array<float, 3>, uint32_t> corners;
    const auto corner = [&](uint32_t vertex) {
        const glm::vec3& p = mesh.positions[vertex];
        return corners.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(corners.size())).first->second;
    };
    std::set<std::pair<uint32_t, uint32_t>> unmatched;
    double volume = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const std::array<uint32_t, 3> c{corner(t.x), corner(t.y), corner(t.z)};
        for (size_t i = 0; i < 3; ++i) {
            const std::pair edge(c[i], c[(i + 1) % 3]);
            if (unmatched.erase({edge.second, edge.first}) == 0 && !unmatched.insert(edge).second)
                return false;
        }
        volume += glm::dot(glm::dvec3(mesh.positions[t.x]),
                           glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
    }
    return unmatched.empty() && volume > 0;
}

double lengthOf(const glm::dvec3& lower, const glm::dvec3& upper) {
    return glm::length(upper - lower);
}

}  // namespace

bool isCullable(const Scene& scene, const WorldInstance& instance) {
    return instance.triangleCount > 0 && instance.mesh != kNone && isCullable(scene, instance.material);
}

bool isCullable(const Scene& scene, const WorldShape& shape) {
    return shape.areaLight == kNone && isCullable(scene, shape.shape.material);
}

BackFaces::BackFaces(const Scene& scene, const WorldGeometry& world) {
    std::map<uint32_t, bool> closed;  // by mesh
    for (const WorldInstance& instance : world.instances) {
        if (!isCullable(scene, instance)) continue;
        any_ = true;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const auto [known, isNew] = closed.try_emplace(instance.mesh, false);
        if (isNew) known->second = isClosedOutwards(mesh);
        const bool whole = known->second && instance.triangleCount == mesh.triangles.size() &&
                           scene.materials[instance.material].alphaMode == AlphaMode::opaque;
        if (!whole) {
            addOpen(world, instance);
            continue;
        }
        Box& box = closed_.emplace_back(Box{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)});
        for (uint32_t i = 0; i < instance.vertexCount; ++i) {
            const glm::dvec3 p(world.positions[instance.firstVertex + i]);
            box.lower = glm::min(box.lower, p);
            box.upper = glm::max(box.upper, p);
        }
    }
    for (const WorldShape& shape : world.shapes)
        if (isCullable(scene, shape)) {
            any_ = true;
            const bool opaque = scene.materials[shape.shape.material].alphaMode == AlphaMode::opaque;
            tooMany_ = tooMany_ || !opaque;
            addShape(shape);
        }
}

void BackFaces::addOpen(const WorldGeometry& world, const WorldInstance& instance) {
    tooMany_ = tooMany_ || open_.size() + instance.triangleCount > kMostFacets;
    if (tooMany_) return;
    for (uint32_t i = 0; i < instance.triangleCount; ++i) {
        const glm::uvec3 t = world.triangles[instance.firstTriangle + i];
        const glm::dvec3 a(world.positions[t.x]), b(world.positions[t.y]), c(world.positions[t.z]);
        open_.push_back({world.positions[t.x], glm::normalize(glm::cross(b - a, c - a))});
    }
}

void BackFaces::addShape(const WorldShape& shape) {
    if (!isFlat(shape.shape.kind)) {
        closed_.push_back({glm::dvec3(shape.lower), glm::dvec3(shape.upper)});
        return;
    }
    const glm::dvec3 front = glm::transpose(glm::inverse(glm::dmat3(shape.shape.toWorld)))[2];
    open_.push_back({glm::vec3(shape.shape.toWorld[3]), glm::normalize(front)});
}

bool BackFaces::mayBeSeen(const CameraPath& path) const {
    if (!any_) return false;
    if (tooMany_ || path.keys.size() > 1) return true;
    const Camera& camera = path.keys.front();
    const glm::dvec3 eye(camera.toWorld[3]), forward = -glm::normalize(glm::dvec3(camera.toWorld[2]));
    // Rays that begin at a plane may begin within what it cuts.
    const bool fromPlane = camera.orthographic || camera.clips;
    const double plane = camera.clips ? camera.znear : 0, lens = camera.apertureRadius;
    const auto mayHold = [&](const Box& box) {
        const double margin = lens + 1e-4 * lengthOf(box.lower, box.upper);
        if (fromPlane) {
            const glm::dvec3 middle = 0.5 * (box.lower + box.upper), half = box.upper - middle;
            return glm::dot(middle - eye, forward) - glm::dot(half, glm::abs(forward)) < plane + margin;
        }
        return glm::all(glm::greaterThanEqual(eye, box.lower - margin)) &&
               glm::all(glm::lessThanEqual(eye, box.upper + margin));
    };
    const auto mayFaceAway = [&](const Facet& facet) {
        const glm::dvec3 away = eye - glm::dvec3(facet.point), normal(facet.normal);
        if (camera.orthographic) return glm::dot(normal, forward) > -1e-4;
        return !(glm::dot(normal, away) > lens + 1e-4 * glm::length(away));
    };
    return std::any_of(closed_.begin(), closed_.end(), mayHold) ||
           std::any_of(open_.begin(), open_.end(), mayFaceAway);
}

}  // namespace tilefarm
