#include "worker/render/overlap.h"

#include <algorithm>
#include <cmath>

namespace tilefarm {
namespace {

constexpr double kRounding = 0x1p-24;
constexpr double kParallel = 0.999;  // as shaders/coplanar.glsl

glm::dvec3 normalOf(const Triangle& t) {
    return glm::cross(t[1] - t[0], t[2] - t[0]);
}

glm::dvec3 largestCoordinates(const Triangle& t) {
    return glm::max(glm::abs(t[0]), glm::max(glm::abs(t[1]), glm::abs(t[2])));
}

/// Whether the corners of `small` are in the plane of `large`. The bound is at least as wide as the kernel's.
bool liesInPlaneOf(const Triangle& large, const glm::dvec3& normal, const Triangle& small) {
    const glm::dvec3 a = glm::abs(large[1] - large[0]), b = glm::abs(large[2] - large[0]);
    const glm::dvec3 products =
        glm::dvec3(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
    const glm::dvec3 largest = glm::max(largestCoordinates(large), largestCoordinates(small));
    return std::all_of(small.begin(), small.end(), [&](const glm::dvec3& corner) {
        const glm::dvec3 way = corner - large[0];
        const double bound = kRounding * (16 * glm::dot(glm::abs(normal), largest) +
                                          8 * glm::length(products) * glm::length(way));
        return std::abs(glm::dot(normal, way)) <= bound;
    });
}

/// How far the projections of both onto an axis reach into each other.
double overlapAlong(const glm::dvec3& axis, const Triangle& a, const Triangle& b) {
    const auto span = [&](const Triangle& t) {
        return std::minmax({glm::dot(axis, t[0]), glm::dot(axis, t[1]), glm::dot(axis, t[2])});
    };
    const auto [lowA, highA] = span(a);
    const auto [lowB, highB] = span(b);
    return std::min(highA, highB) - std::max(lowA, lowB);
}

/// Separating axes, which in a plane are the edges' normals.
bool anyEdgeSeparates(const Triangle& edges, const glm::dvec3& normal, const Triangle& a, const Triangle& b,
                      double tolerance) {
    for (size_t i = 0; i < 3; ++i) {
        const glm::dvec3 axis = glm::cross(normal, edges[(i + 1) % 3] - edges[i]);
        if (!(overlapAlong(axis, a, b) > tolerance * glm::length(axis))) return true;
    }
    return false;
}

double lengthOf(const Triangle& t) {
    return std::max({glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
}

}  // namespace

bool overlapInOnePlane(const Triangle& a, const Triangle& b) {
    const glm::dvec3 normalA = normalOf(a), normalB = normalOf(b);
    if (!(std::abs(glm::dot(normalA, normalB)) > kParallel * glm::length(normalA) * glm::length(normalB)))
        return false;
    const double lengthA = lengthOf(a), lengthB = lengthOf(b);
    const bool aIsLarge = lengthA >= lengthB;
    const glm::dvec3& normal = aIsLarge ? normalA : normalB;
    if (!liesInPlaneOf(aIsLarge ? a : b, normal, aIsLarge ? b : a)) return false;
    const glm::dvec3 largest = glm::max(largestCoordinates(a), largestCoordinates(b));
    const double tolerance =
        4 * kRounding * std::max({largest.x, largest.y, largest.z}) + 1e-6 * std::min(lengthA, lengthB);
    return !anyEdgeSeparates(a, normal, a, b, tolerance) && !anyEdgeSeparates(b, normal, a, b, tolerance);
}

}  // namespace tilefarm
