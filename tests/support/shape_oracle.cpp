#include "tests/support/shape_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace tilefarm {
namespace {

using glm::dvec2;
using glm::dvec3;

double boxDistance(const dvec3& p, const dvec3& h) {
    const dvec3 q = glm::abs(p) - h;
    return glm::length(glm::max(q, dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

double segmentDistance(const dvec2& p, const dvec2& a, const dvec2& b) {
    const dvec2 along = b - a;
    const double length2 = glm::dot(along, along);
    const double s = length2 > 0 ? glm::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0;
    return glm::length(p - a - s * along);
}

// Of the half profile (0,-h) (rb,-h) (rt,h) (0,h) turned round the axis.
double frustumDistance(const dvec3& p, double h, double rb, double rt) {
    const dvec2 q(std::hypot(p.x, p.z), p.y);
    const double outline =
        std::min({segmentDistance(q, {0, -h}, {rb, -h}), segmentDistance(q, {rb, -h}, {rt, h}),
                  segmentDistance(q, {rt, h}, {0, h})});
    const bool inside = std::abs(q.y) < h && q.x < rb + (rt - rb) * (q.y + h) / (2 * h);
    return inside ? -outline : outline;
}

// The hull of two spheres is the union of all between them: the largest circle that reaches out to the point.
double capsuleDistance(const dvec3& p, double h, double rb, double rt) {
    const dvec2 q(std::hypot(p.x, p.z), p.y);
    // |q − (0, y)| − r(y) with r linear is least where the direction to q leans by the cone's slope.
    const double slope = (rt - rb) / (2 * h);
    const double y = glm::clamp(q.y + q.x * slope / std::sqrt(1 - slope * slope), -h, h);
    return std::hypot(q.x, q.y - y) - (rb + (rt - rb) * (y + h) / (2 * h));
}

double mandelbulbDistance(const dvec3& p, double power, int iterations) {
    dvec3 z = p;
    double derivative = 1, r = glm::length(z);
    for (int i = 0; i < iterations && r < 2; ++i) {
        if (r < 1e-6) return -1e-6;
        const double theta = std::acos(z.z / r) * power, phi = std::atan2(z.y, z.x) * power;
        derivative = std::pow(r, power - 1) * power * derivative + 1;
        z = std::pow(r, power) *
                dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)) +
            p;
        r = glm::length(z);
    }
    return r < 2 ? -1e-6 : 0.5 * std::log(r) * r / derivative;
}

double smoothMinimum(double a, double b, double k) {
    const double h = k > 0 ? std::max(k - std::abs(a - b), 0.0) / k : 0;
    return std::min(a, b) - h * h * k / 4;
}

double primitiveDistance(const FieldInstruction& i, const dvec3& at) {
    const glm::dquat rotation(i.rotation.w, i.rotation.x, i.rotation.y, i.rotation.z);
    const dvec3 p = glm::conjugate(rotation) * (at - i.translation);
    const glm::dvec4& q = i.parameters;
    switch (i.operation) {
        case FieldOperation::sphere: return glm::length(p) - q.x;
        case FieldOperation::box: return boxDistance(p, dvec3(q) - q.w) - q.w;
        case FieldOperation::torus: return std::hypot(std::hypot(p.x, p.z) - q.x, p.y) - q.y;
        case FieldOperation::cone: return frustumDistance(p, q.x, q.y, q.z);
        default: return mandelbulbDistance(p, q.x, static_cast<int>(q.y));
    }
}

double fieldDistance(const std::vector<FieldInstruction>& field, const dvec3& p) {
    std::vector<double> stack;
    for (const FieldInstruction& i : field) {
        if (i.operation < FieldOperation::unite) {
            stack.push_back(primitiveDistance(i, p));
            continue;
        }
        const double b = stack.back();
        stack.pop_back();
        double& a = stack.back();
        const double k = i.parameters.x;
        a = i.operation == FieldOperation::unite       ? smoothMinimum(a, b, k)
            : i.operation == FieldOperation::intersect ? -smoothMinimum(-a, -b, k)
                                                       : -smoothMinimum(-a, b, k);
    }
    return stack.back();
}

}  // namespace

double exactDistance(const Shape& shape, const dvec3& p) {
    const dvec3 size = shape.size;
    switch (shape.kind) {
        case ShapeKind::sphere: return glm::length(p) - size.x;
        case ShapeKind::box: return boxDistance(p, size);
        case ShapeKind::rectangle: return boxDistance(p, {size.x, size.y, 0});
        case ShapeKind::disk: {
            const double rho = std::hypot(p.x, p.y);
            return std::hypot(std::max(rho - size.x, 0.0), p.z);
        }
        case ShapeKind::cylinder: return frustumDistance(p, size.x, size.y, size.z);
        case ShapeKind::capsule: return capsuleDistance(p, size.x, size.y, size.z);
        case ShapeKind::field: return fieldDistance(shape.field, p);
    }
    return 0;
}

ExactShapeHit exactHit(const Shape& shape, const dvec3& origin, const dvec3& direction) {
    const glm::dmat4 toOwn = glm::inverse(shape.toWorld);
    const dvec3 o(toOwn * glm::dvec4(origin, 1)), d = glm::dmat3(toOwn) * direction;
    const double length = glm::length(d);
    const dvec3 u = d / length;
    const ShapeBounds bounds = [&] {
        Shape own = shape;
        own.toWorld = glm::dmat4(1);
        return boundsOf(own);
    }();
    const double size = glm::length(bounds.upper - bounds.lower), end = glm::length(o) + 4 * size;
    const bool estimate = shape.kind == ShapeKind::field &&
                          std::any_of(shape.field.begin(), shape.field.end(),
                                      [](auto& i) { return i.operation == FieldOperation::mandelbulb; });
    ExactShapeHit result;
    double s = 0, distance = exactDistance(shape, o);
    const double side = distance < 0 ? -1 : 1;
    result.nearest = std::abs(distance);
    for (int i = 0; i < 200'000 && s < end; ++i) {
        s += std::max(side * distance * (estimate ? 0.2 : 1), 1e-12 * size);
        distance = exactDistance(shape, o + s * u);
        if (side * distance < 1e-11 * size) {
            result.hit = true;
            result.t = s / length;
            const dvec3 own = o + s * u;
            const double h = 1e-6 * size;
            dvec3 gradient;
            for (int k = 0; k < 3; ++k) {
                dvec3 step(0);
                step[k] = h;
                gradient[k] = exactDistance(shape, own + step) - exactDistance(shape, own - step);
            }
            if (shape.kind == ShapeKind::rectangle || shape.kind == ShapeKind::disk) gradient = {0, 0, 1};
            result.position = origin + result.t * direction;
            result.normal = glm::normalize(glm::transpose(glm::dmat3(toOwn)) * gradient);
            return result;
        }
        result.nearest = std::min(result.nearest, std::abs(distance));
    }
    return result;
}

}  // namespace tilefarm
