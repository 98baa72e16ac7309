#include "worker/render/coincidence.h"

#include <algorithm>

#include "worker/bvh/box_query.h"
#include "worker/render/overlap.h"

namespace tilefarm {
namespace {

bool transmits(const Material& m) {
    return (m.transmission > 0 || m.diffuseTransmission > 0) && !m.unlit;
}

bool isRound(ShapeKind kind) {
    return kind == ShapeKind::sphere || kind == ShapeKind::cylinder || kind == ShapeKind::capsule;
}

/// Both halves of the parallelogram around `centre`.
void addParallelogram(const Shape& shape, const glm::dvec3& centre, const glm::dvec3& a, const glm::dvec3& b,
                      std::vector<Triangle>& faces) {
    const auto at = [&](double u, double v) {
        return glm::dvec3(shape.toWorld * glm::dvec4(centre + u * a + v * b, 1));
    };
    faces.push_back({at(-1, -1), at(1, -1), at(1, 1)});
    faces.push_back({at(-1, -1), at(1, 1), at(-1, 1)});
}

/// What is flat of a shape; round faces by the squares around them.
std::vector<Triangle> flatFacesOf(const Shape& shape) {
    std::vector<Triangle> faces;
    const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), size = shape.size;
    if (shape.kind == ShapeKind::rectangle)
        addParallelogram(shape, glm::dvec3(0), size.x * x, size.y * y, faces);
    if (shape.kind == ShapeKind::disk) addParallelogram(shape, glm::dvec3(0), size.x * x, size.x * y, faces);
    for (const double side : {-1.0, 1.0}) {
        if (shape.kind == ShapeKind::box) {
            addParallelogram(shape, side * size.x * x, size.y * y, size.z * z, faces);
            addParallelogram(shape, side * size.y * y, size.z * z, size.x * x, faces);
            addParallelogram(shape, side * size.z * z, size.x * x, size.y * y, faces);
        }
        const double radius = side < 0 ? size.y : size.z;
        if (shape.kind == ShapeKind::cylinder && radius > 0)
            addParallelogram(shape, side * size.x * y, radius * x, radius * z, faces);
    }
    return faces;
}

class Search {
public:
    Search(const Bvh& bvh, const Scene& scene, const WorldGeometry& world)
        : bvh_(bvh), scene_(scene), world_(world) {
        for (const WorldShape& shape : world.shapes) shapeFaces_.push_back(flatFacesOf(shape.shape));
        for (size_t i = 0; i < world.materialCount(scene); ++i)
            transmits_.push_back(transmits(world.materialOf(scene, static_cast<uint32_t>(i))));
        found_.interfaces.resize(transmits_.size());
    }

    Coincidence run() {
        for (uint32_t i = 0; i < bvh_.triangleCount; ++i) {
            const uint32_t texel = i * kBvhTriangleTexels, a = primitiveAt(texel);
            visitTouching(bvh_, boxOf(a), [&](uint32_t other) {
                if (other > texel) look(a, primitiveAt(other));
            });
        }
        return std::move(found_);
    }

private:
    uint32_t primitiveAt(uint32_t texel) const {
        return bvh_.triangles[texel].w & ~(kBvhNonOpaque | kBvhShape | kBvhSingleSided);
    }
    bool isShape(uint32_t primitive) const { return primitive >= world_.triangleCount(); }
    const WorldShape& shapeOf(uint32_t primitive) const {
        return world_.shapes[primitive - world_.triangleCount()];
    }

    Triangle triangleOf(uint32_t primitive) const {
        const glm::uvec3 t = world_.triangles[primitive];
        return {world_.positions[t.x], world_.positions[t.y], world_.positions[t.z]};
    }

    /// Wider than the primitive by what rounding may move a face that coincides with it.
    BvhBox boxOf(uint32_t primitive) const {
        BvhBox box;
        if (isShape(primitive)) {
            box = {shapeOf(primitive).lower, shapeOf(primitive).upper};
        } else {
            const glm::uvec3 t = world_.triangles[primitive];
            const glm::vec3 &a = world_.positions[t.x], &b = world_.positions[t.y],
                            &c = world_.positions[t.z];
            box = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
        }
        const glm::vec3 more = 2e-6f * glm::max(glm::abs(box.lower), glm::abs(box.upper));
        return {box.lower - more, box.upper + more};
    }

    uint32_t materialOf(uint32_t primitive) const {
        return isShape(primitive) ? shapeOf(primitive).shape.material : world_.instanceOf(primitive).material;
    }

    void look(uint32_t a, uint32_t b) {
        const uint32_t materialA = materialOf(a), materialB = materialOf(b);
        const bool lets = transmits_[materialA] || transmits_[materialB];
        if (found_.any && (!lets || (found_.interfaces[materialA] && found_.interfaces[materialB]))) return;
        if (!coincide(a, b, lets)) return;
        found_.any = true;
        if (lets) found_.interfaces[materialA] = found_.interfaces[materialB] = true;
    }

    bool coincide(uint32_t a, uint32_t b, bool lets) const {
        if (!isShape(a) && !isShape(b)) return overlapInOnePlane(triangleOf(a), triangleOf(b));
        if (isShape(a) && isShape(b) && lets && shapeOf(a).shape.kind == shapeOf(b).shape.kind &&
            isRound(shapeOf(a).shape.kind))
            return true;
        const std::vector<Triangle> facesA = facesOf(a), facesB = facesOf(b);
        return std::any_of(facesA.begin(), facesA.end(), [&](const Triangle& one) {
            return std::any_of(facesB.begin(), facesB.end(),
                               [&](const Triangle& other) { return overlapInOnePlane(one, other); });
        });
    }

    std::vector<Triangle> facesOf(uint32_t primitive) const {
        if (!isShape(primitive)) return {triangleOf(primitive)};
        return shapeFaces_[primitive - world_.triangleCount()];
    }

    const Bvh& bvh_;
    const Scene& scene_;
    const WorldGeometry& world_;
    std::vector<std::vector<Triangle>> shapeFaces_;
    std::vector<bool> transmits_;  // by material
    Coincidence found_;
};

}  // namespace

Coincidence findCoincidence(const Bvh& bvh, const Scene& scene, const WorldGeometry& world) {
    return Search(bvh, scene, world).run();
}

}  // namespace tilefarm
