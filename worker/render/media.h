#pragma once

#include <array>
#include <optional>
#include <vector>

#include "shaders/gpu_types.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// A surface around a transmissive solid, in the space of the geometry.
struct Solid {
    uint32_t material = 0;
    glm::dvec3 lower{0}, upper{0};
    std::vector<std::array<glm::vec3, 3>> triangles;  // or
    std::optional<Shape> shape;
    /// Whether a point is inside: of triangles by their winding number (Jacobson et al. 2013), so meshes with
    /// small holes have an inside too; shapes made of a field, flat ones and capsules of two radii have none.
    bool holds(const glm::dvec3& point) const;
    double volumeOfBox() const;
};

/// What absorbs or refracts inside of surfaces, and where it may lie within another. An instance or a shape
/// with a transmissive material that is not thin-walled is a solid of its own.
class Solids {
public:
    Solids() = default;
    Solids(const Scene& scene, const WorldGeometry& world);

    /// Whether the boxes of two of them touch: only then can a ray be in both.
    bool nested() const { return nested_; }
    /// Materials of the solids that hold a point, the innermost (smallest) first, then NO_INDEX: the stack of
    /// shaders/path/media_stack.glsl. Of more than four the innermost four.
    glm::uvec4 mediaAt(const glm::dvec3& point) const;

private:
    std::vector<Solid> solids_;
    bool nested_ = false;
};

/// Fills the members of FrameParameters about media, and gives the FEATURE_* that they call for. `eye` is
/// where the camera is at first, in the space of the geometry: all its rays start in the media that hold it.
uint64_t setMedia(gpu::FrameParameters& parameters, const Solids& solids, const glm::dvec3& eye);

}  // namespace tilefarm
