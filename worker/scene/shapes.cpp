#include "worker/scene/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

/// The box of the shape's own space that holds it.
ShapeBounds ownBounds(const Shape& shape) {
    const glm::dvec3 size = shape.size;
    const double widest = std::max(size.y, size.z);
    switch (shape.kind) {
        case ShapeKind::sphere: return {glm::dvec3(-size.x), glm::dvec3(size.x)};
        case ShapeKind::box: return {-size, size};
        case ShapeKind::rectangle: return {{-size.x, -size.y, 0}, {size.x, size.y, 0}};
        case ShapeKind::disk: return {{-size.x, -size.x, 0}, {size.x, size.x, 0}};
        case ShapeKind::cylinder: return {{-widest, -size.x, -widest}, {widest, size.x, widest}};
        case ShapeKind::capsule:
            return {{-widest, -size.x - size.y, -widest}, {widest, size.x + size.z, widest}};
        case ShapeKind::field: return boundsOf(shape.field);
    }
    return {};
}

bool isRound(ShapeKind kind) {
    return kind == ShapeKind::sphere || kind == ShapeKind::disk;
}

/// Half sides of the box around a sphere, or around a box, with these half axes.
glm::dvec3 extentOf(const glm::dmat3& axes, bool round) {
    if (round) return glm::sqrt(axes[0] * axes[0] + axes[1] * axes[1] + axes[2] * axes[2]);
    return glm::abs(axes[0]) + glm::abs(axes[1]) + glm::abs(axes[2]);
}

glm::dmat3 rotationOf(const glm::dvec4& q) {
    return glm::mat3_cast(glm::dquat(q.w, q.x, q.y, q.z));
}

/// Half sides around a primitive of a field, not yet turned.
glm::dvec3 extentOf(const FieldInstruction& primitive) {
    const glm::dvec4& p = primitive.parameters;
    switch (primitive.operation) {
        case FieldOperation::sphere: return glm::dvec3(p.x);
        case FieldOperation::box: return glm::dvec3(p);
        case FieldOperation::torus: return {p.x + p.y, p.y, p.x + p.y};
        case FieldOperation::cone: return {std::max(p.y, p.z), p.x, std::max(p.y, p.z)};
        default: return glm::dvec3(std::exp2(1 / (p.x - 1)));  // points further out escape
    }
}

ShapeBounds combined(FieldOperation operation, const ShapeBounds& a, const ShapeBounds& b, double smooth) {
    switch (operation) {
        case FieldOperation::unite:  // the smooth minimum is less by a quarter of the length at most
            return {glm::min(a.lower, b.lower) - smooth / 4, glm::max(a.upper, b.upper) + smooth / 4};
        case FieldOperation::intersect: return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)};
        default: return a;
    }
}

}  // namespace

ShapeBounds boundsOf(const std::vector<FieldInstruction>& field) {
    std::vector<ShapeBounds> stack;
    for (const FieldInstruction& instruction : field) {
        if (instruction.operation < FieldOperation::unite) {
            const glm::dvec3 own = extentOf(instruction);
            const glm::dmat3 turned = rotationOf(instruction.rotation);
            const glm::dvec3 extent =
                extentOf(glm::dmat3(turned[0] * own.x, turned[1] * own.y, turned[2] * own.z), false);
            stack.push_back({instruction.translation - extent, instruction.translation + extent});
        } else {
            const ShapeBounds second = stack.back();
            stack.pop_back();
            stack.back() = combined(instruction.operation, stack.back(), second, instruction.parameters.x);
        }
    }
    return stack.empty() ? ShapeBounds{glm::dvec3(1), glm::dvec3(-1)} : stack.front();
}

ShapeBounds boundsOf(const Shape& shape) {
    const ShapeBounds own = ownBounds(shape);
    const glm::dvec3 half = 0.5 * (own.upper - own.lower);
    const glm::dmat3 linear(shape.toWorld);
    const glm::dvec3 centre(shape.toWorld * glm::dvec4(0.5 * (own.lower + own.upper), 1));
    const glm::dvec3 extent =
        extentOf(glm::dmat3(linear[0] * half.x, linear[1] * half.y, linear[2] * half.z), isRound(shape.kind));
    return {centre - extent, centre + extent};
}

bool isProper(const Shape& shape) {
    const ShapeBounds own = ownBounds(shape);
    const glm::dvec3 sides = own.upper - own.lower;
    const bool flat = shape.kind == ShapeKind::rectangle || shape.kind == ShapeKind::disk;
    if (!(sides.x > 0 && sides.y > 0 && (flat || sides.z > 0)) || !isFinite(shape.toWorld)) return false;
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
        case ShapeKind::cylinder: return "cylinder";
        case ShapeKind::capsule: return "capsule";
        case ShapeKind::field: return "field";
    }
    return "";
}

bool isFlat(ShapeKind kind) {
    return kind == ShapeKind::rectangle || kind == ShapeKind::disk;
}

}  // namespace tilefarm
