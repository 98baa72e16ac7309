#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

/// Surfaces that are not triangles.
namespace tilefarm {

enum class ShapeKind : uint32_t {
    sphere,     // size: radius
    box,        // half sides along x, y, z
    rectangle,  // half sides along x and y; in z = 0, its front towards +z
    disk,       // radius; in z = 0, its front towards +z
};

struct Shape {
    ShapeKind kind = ShapeKind::sphere;
    glm::dvec3 size{1};
    glm::dmat4 toWorld{1};  // composed in double
    uint32_t material = 0;
    std::string name;
};

struct ShapeBounds {
    glm::dvec3 lower{0}, upper{0};
};

/// The smallest axis-parallel box, in world space, around a shape.
ShapeBounds boundsOf(const Shape& shape);

/// Whether it has an inside: its transform does not collapse it and all numbers are finite.
bool isProper(const Shape& shape);

/// Whether the transform stretches all directions alike, up to rounding: then a sphere stays one.
bool isSimilarity(const glm::dmat4& toWorld);

const char* nameOf(ShapeKind kind);

}  // namespace tilefarm
