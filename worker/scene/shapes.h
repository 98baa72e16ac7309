#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

/// Surfaces that are not triangles.
namespace tilefarm {

enum class ShapeKind : uint32_t {
    sphere,     // size: radius
    box,        // half sides along x, y, z
    rectangle,  // half sides along x and y; in z = 0, its front towards +z
    disk,       // radius; in z = 0, its front towards +z
    cylinder,   // half height along y, radius at the bottom, at the top; one radius may be 0
    capsule,    // half the distance of two centres along y, radius around the lower, around the upper
    field,      // where a signed distance is zero
};

/// Primitives of a field; then what combines the two before it.
enum class FieldOperation : uint32_t {
    sphere,      // parameters: radius
    box,         // half sides, radius of the rounded edges (within the half sides)
    torus,       // around y: radius of the ring, of the tube
    cone,        // along y: half height, radius at the bottom, at the top
    mandelbulb,  // power, iterations
    unite,       // length over which the seam is smoothed
    intersect,
    subtract,  // the second from the first
};

struct FieldInstruction {
    FieldOperation operation = FieldOperation::sphere;
    glm::dvec4 parameters{0};
    glm::dvec3 translation{0};
    glm::dvec4 rotation{0, 0, 0, 1};  // unit quaternion xyzw
};

inline constexpr size_t kMaxFieldInstructions = 64;
inline constexpr uint32_t kMaxFieldStack = 8;

struct Shape {
    ShapeKind kind = ShapeKind::sphere;
    glm::dvec3 size{1};
    glm::dmat4 toWorld{1};  // composed in double
    uint32_t material = 0;
    std::vector<FieldInstruction> field;  // in postfix order
    std::string name;
};

struct ShapeBounds {
    glm::dvec3 lower{0}, upper{0};
};

/// The smallest axis-parallel box, in world space, around a shape.
ShapeBounds boundsOf(const Shape& shape);

/// The box, in the space of the field, around what its surface can be; lower above upper where there is none.
ShapeBounds boundsOf(const std::vector<FieldInstruction>& field);

/// Whether it has a surface: its transform does not collapse it and all numbers are finite.
bool isProper(const Shape& shape);

/// Whether the transform stretches all directions alike, up to rounding: then a sphere stays one.
bool isSimilarity(const glm::dmat4& toWorld);

const char* nameOf(ShapeKind kind);

/// Whether it encloses nothing.
bool isFlat(ShapeKind kind);

}  // namespace tilefarm
