#include "worker/scene/shapes.h"

#include <algorithm>
#include <cmath>

namespace tilefarm {
namespace {

/// Half sides of the box around the origin of the shape's own space that holds it.
glm::dvec3 ownExtent(const Shape& shape) {
    switch (shape.kind) {
        case ShapeKind::sphere: return glm::dvec3(shape.size.x);
        case ShapeKind::box: return shape.size;
        case ShapeKind::rectangle: return {shape.size.x, shape.size.y, 0};
        case ShapeKind::disk: return {shape.size.x, shape.size.x, 0};
    }
    return glm::dvec3(0);
}

/// Half sides, in the world, of the box around an ellipsoid with these axes.
glm::dvec3 extentOfEllipsoid(const glm::dmat3& axes) {
    return glm::sqrt(axes[0] * axes[0] + axes[1] * axes[1] + axes[2] * axes[2]);
}

glm::dvec3 extentOf(const Shape& shape) {
    const glm::dmat3 linear(shape.toWorld);
    const glm::dvec3 own = ownExtent(shape);
    const glm::dmat3 axes(linear[0] * own.x, linear[1] * own.y, linear[2] * own.z);
    if (shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::disk) return extentOfEllipsoid(axes);
    return glm::abs(axes[0]) + glm::abs(axes[1]) + glm::abs(axes[2]);
}

bool isFinite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

}  // namespace

ShapeBounds boundsOf(const Shape& shape) {
    const glm::dvec3 centre(shape.toWorld[3]), extent = extentOf(shape);
    return {centre - extent, centre + extent};
}

bool isProper(const Shape& shape) {
    const bool sized =
        shape.size.x > 0 && (shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::disk ||
                             (shape.size.y > 0 && (shape.kind == ShapeKind::rectangle || shape.size.z > 0)));
    if (!sized || !isFinite(shape.toWorld)) return false;
    const glm::dmat3 linear(shape.toWorld);
    const double volume = std::abs(glm::determinant(linear));
    const double box = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    // Flatter than this the inverse has no bits left in float.
    return volume > 1e-9 * box && std::isfinite(box);
}

bool isSimilarity(const glm::dmat4& toWorld) {
    const glm::dmat3 linear(toWorld);
    const glm::dmat3 gram = glm::transpose(linear) * linear;
    const double mean = (gram[0][0] + gram[1][1] + gram[2][2]) / 3;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(gram[c][r] - (c == r ? mean : 0)) <= 1e-7 * mean)) return false;
    return true;
}

const char* nameOf(ShapeKind kind) {
    switch (kind) {
        case ShapeKind::sphere: return "sphere";
        case ShapeKind::box: return "box";
        case ShapeKind::rectangle: return "rectangle";
        case ShapeKind::disk: return "disk";
    }
    return "";
}

}  // namespace tilefarm
