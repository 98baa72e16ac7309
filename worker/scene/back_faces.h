#pragma once

#include <vector>

#include "worker/scene/world.h"

/// The backs of materials that are not double-sided, which a job may have rays pass (Culling).
namespace tilefarm {

/// Whether the backs of an instance's or a shape's faces may be passed: glTF 2.0, 3.9.6. Not those of volume
/// boundaries, on which doubleSided has no effect (KHR_materials_volume), and not of area lights.
bool isCullable(const Scene& scene, const WorldInstance& instance);
bool isCullable(const Scene& scene, const WorldShape& shape);

/// Which of a scene's culled backs a camera might see: it keeps what that takes to say for any camera.
class BackFaces {
public:
    BackFaces() = default;
    BackFaces(const Scene& scene, const WorldGeometry& world);

    /// Whether there are faces to cull at all.
    bool any() const { return any_; }
    /// False only if no ray of the camera, in the space of the geometry, meets a back before anything else:
    /// all faces are turned towards it, or belong to closed opaque surfaces that it is outside of. May be
    /// true without need.
    bool mayBeSeen(const CameraPath& path) const;

private:
    struct Box {
        glm::dvec3 lower{0}, upper{0};
    };
    struct Facet {
        glm::vec3 point{0}, normal{0};  // any length
    };
    void addOpen(const WorldGeometry& world, const WorldInstance& instance);
    void addShape(const WorldShape& shape);

    bool any_ = false, tooMany_ = false;
    std::vector<Box> closed_;
    std::vector<Facet> open_;
};

}  // namespace tilefarm
