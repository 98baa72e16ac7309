// Spheres and ellipsoids against double precision.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/shader/device_fixture.h"
#include "tests/shader/shape_probe.h"

namespace tilefarm {
namespace {

constexpr double kEpsilon = 0x1p-24;

class Spheres : public DeviceTest {};

Shape sphereOf(glm::dvec3 centre, double radius) {
    Shape shape;
    shape.size = glm::dvec3(radius);
    shape.toWorld[3] = glm::dvec4(centre, 1);
    return shape;
}

// Both crossings with the sphere around the origin, in long double, from what the kernel was given.
struct Exact {
    bool any = false;
    long double impact = 0, near = 0, far = 0;
};

Exact exactCrossings(const TestRay& ray, long double r) {
    long double ff = 0, fd = 0, dd = 0;
    for (int k = 0; k < 3; ++k) {
        const long double f = ray.origin[k], d = ray.direction[k];
        ff += f * f, fd += f * d, dd += d * d;
    }
    // The squared distance by Lagrange's identity: no cancellation.
    long double cross = 0;
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const long double c = static_cast<long double>(ray.origin[a]) * ray.direction[b] -
                              static_cast<long double>(ray.origin[b]) * ray.direction[a];
        cross += c * c;
    }
    Exact exact;
    exact.impact = std::sqrt(cross / dd);
    if (exact.impact > r) return exact;
    const long double h = std::sqrt((r - exact.impact) * (r + exact.impact) / dd), middle = -fd / dd;
    exact.any = true;
    exact.near = middle - h;
    exact.far = middle + h;
    return exact;
}

// Rays that pass the centre at about `impact` from `distance` away, around a sphere at the origin.
std::vector<TestRay> raysAt(double distance, double impact, uint64_t seed, int count) {
    RandomNumbers random(seed);
    std::vector<TestRay> rays;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 to(random.direction());
        const glm::dvec3 side = glm::normalize(glm::cross(to, glm::dvec3(random.direction())));
        TestRay ray;
        ray.origin = -distance * to + impact * side;
        ray.direction = glm::normalize(glm::vec3(to));
        rays.push_back(ray);
    }
    return rays;
}

struct SphereErrors {
    size_t hits = 0, wrong = 0, offT = 0, offSurface = 0, notFinite = 0;
};

// Hard case 7's bounds. Its |oc| stands for max(|oc|, r) here: from inside, near the centre of a large
// sphere, t is about r and cannot be better than a rounding of it.
SphereErrors errorsOf(const std::vector<TestRay>& rays, const std::vector<ShapeHit>& hits, float radius) {
    SphereErrors result;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Exact exact = exactCrossings(rays[i], radius);
        const double away = std::max<double>(glm::length(glm::dvec3(rays[i].origin)), radius);
        const double band = 8 * kEpsilon * away;
        const bool inBand = std::abs(static_cast<double>(exact.impact) - radius) <= band;
        // The origin's own side is not to be told nearer to the surface than that either.
        const bool onSurface = std::abs(glm::length(glm::dvec3(rays[i].origin)) - radius) <= band;
        const long double t = exact.near > 0 ? exact.near : exact.far;
        const bool expected = exact.any && t > 0;
        if (hits[i].missed() == expected) {
            result.wrong += !inBand && !onSurface;
            continue;
        }
        if (hits[i].missed()) continue;
        ++result.hits;
        const double root = std::sqrt(std::max(0.0, (radius - static_cast<double>(exact.impact)) *
                                                        (radius + static_cast<double>(exact.impact))));
        const double allowed = band * (1 + radius / std::max(root, 1e-300));
        if (!inBand && !onSurface && std::abs(hits[i].t - static_cast<double>(t)) > allowed) ++result.offT;
        const double ulp = std::nextafter(radius, 2 * radius) - radius;
        if (std::abs(glm::length(glm::dvec3(hits[i].position)) - radius) > 4 * ulp) ++result.offSurface;
        const glm::vec3 all = hits[i].position + hits[i].normal + hits[i].error + hits[i].tangent;
        if (!std::isfinite(all.x + all.y + all.z + hits[i].u + hits[i].v)) ++result.notFinite;
    }
    return result;
}

TEST_F(Spheres, HardCase07_CrossingsEqualDoublePrecisionWithinTheirBounds) {
    size_t hits = 0;
    for (const double radius : {1e-3, 0.25, 1.0, 1e3, 1e6}) {
        ShapeProbe probe(device, {sphereOf(glm::dvec3(0), static_cast<float>(radius))});
        std::vector<TestRay> rays;
        for (const double distance : {1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7})
            for (const double share : {0.0, 0.3, 0.9, 1 - 1e-3, 1 - 1e-6, 1 + 1e-6, 1 + 1e-3, 1.5}) {
                const auto more = raysAt(distance, share * radius, rays.size() + 1, 200);
                rays.insert(rays.end(), more.begin(), more.end());
            }
        const auto traced = probe.trace(rays);
        const SphereErrors errors = errorsOf(rays, traced, static_cast<float>(radius));
        EXPECT_EQ(errors.wrong, 0u) << "radius " << radius;
        EXPECT_EQ(errors.offT, 0u) << "radius " << radius;
        EXPECT_EQ(errors.offSurface, 0u) << "radius " << radius;
        EXPECT_EQ(errors.notFinite, 0u) << "radius " << radius;
        hits += errors.hits;
    }
    EXPECT_GT(hits, 20'000u);
}

TEST_F(Spheres, RaysThatStartOnThemGoWhereTheyShould) {
    for (const glm::dvec3 centre : {glm::dvec3(0), glm::dvec3(300, -20, 7)}) {
        // A second sphere keeps the world's centre off the first.
        ShapeProbe probe(device, {sphereOf(centre, 0.5), sphereOf(centre + glm::dvec3(90, 100, 120), 10)});
        RandomNumbers random(3);
        std::vector<TestRay> rays;
        for (int i = 0; i < 100'000; ++i) {
            TestRay ray;
            const glm::dvec3 target = centre + 0.5 * glm::dvec3(random.direction());
            ray.origin = centre + 2.0 * glm::dvec3(random.direction()) - probe.centre();
            ray.direction = glm::normalize(glm::vec3(target - probe.centre()) - ray.origin);
            rays.push_back(ray);
        }
        const auto hits = probe.trace(rays);
        size_t lost = 0, stuck = 0, found = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].missed() || hits[i].primitive != 0) continue;
            const double inwards =
                std::abs(glm::dot(glm::dvec3(hits[i].normal), glm::dvec3(rays[i].direction)));
            if (inwards < 1e-5) continue;  // along the surface but for roundings: either side is right
            ++found;
            // The chord through the sphere is 2 r cos θ; grazing ones end where the offset has moved them.
            const double chord = 2 * 0.5 * inwards;
            if (std::abs(hits[i].nextForwards - chord) > 1e-3 * chord + 2e-5 / std::max(inwards, 1e-3))
                ++lost;
            if (hits[i].nextBack >= 0 && hits[i].nextBack < 0.5) ++stuck;
        }
        EXPECT_GT(found, 90'000u);
        EXPECT_EQ(lost, 0u);
        EXPECT_EQ(stuck, 0u) << "rays that go back must not meet the sphere again";
    }
}

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

TEST_F(Spheres, HardCase14_NormalsOfStretchedSpheresAreThoseOfTheEllipsoid) {
    Shape shape = sphereOf({2, -3, 5}, 1);
    shape.toWorld = shape.toWorld * glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3))) *
                    glm::scale(glm::dmat4(1), glm::dvec3(1, 10, 0.1));
    ShapeProbe probe(device, {shape});
    const glm::dmat4 toOwn = glm::inverse(shape.toWorld);
    RandomNumbers random(4);
    std::vector<TestRay> rays;
    for (int i = 0; i < 50'000; ++i) {
        TestRay ray;
        const glm::dvec3 target(shape.toWorld *
                                glm::dvec4(0.9 * random.unit() * glm::dvec3(random.direction()), 1));
        ray.origin = glm::dvec3(2, -3, 5) + 15.0 * glm::dvec3(random.direction()) - probe.centre();
        ray.direction = glm::normalize(glm::vec3(target - probe.centre()) - ray.origin);
        rays.push_back(ray);
    }
    const auto hits = probe.trace(rays);
    double worst = 0, worstUv = 0;
    size_t lost = 0;
    for (const ShapeHit& hit : hits) {
        if (hit.missed()) {
            ++lost;
            continue;
        }
        const glm::dvec3 own(toOwn * glm::dvec4(glm::dvec3(hit.position) + probe.centre(), 1));
        const glm::dvec3 normal = glm::transpose(glm::dmat3(toOwn)) * own;
        worst = std::max(worst, angleBetween(normal, hit.normal));
        const double v = std::acos(glm::clamp(own.y / glm::length(own), -1.0, 1.0)) / std::numbers::pi;
        worstUv = std::max(worstUv, std::abs(v - hit.v));
        EXPECT_NEAR(glm::dot(hit.tangent, hit.normal), 0, 1e-5);
    }
    EXPECT_EQ(lost, 0u);
    EXPECT_LE(worst, 1e-4);
    EXPECT_LE(worstUv, 1e-4);
}

TEST_F(Spheres, WindTheirTexturesRoundThemAsSeenFromOutside) {
    ShapeProbe probe(device, {sphereOf(glm::dvec3(0), 1)});
    const auto at = [&](glm::vec3 from) {
        TestRay ray;
        ray.origin = 3.0f * from;
        ray.direction = -from;
        return probe.trace(std::span(&ray, 1)).front();
    };
    // The device's atan is good for some 1e-6.
    EXPECT_NEAR(at({0, 0, 1}).u, 0.25, 1e-5);
    EXPECT_NEAR(at({1, 0, 0}).u, 0.5, 1e-5);
    EXPECT_NEAR(at({0, 0, -1}).u, 0.75, 1e-5);
    EXPECT_NEAR(at({1, 0, 0}).v, 0.5, 1e-5);
    EXPECT_NEAR(at(glm::normalize(glm::vec3(1, 1, 0))).v, 0.25, 1e-5);
    const ShapeHit front = at({0, 0, 1});
    EXPECT_NEAR(front.tangent.x, 1, 1e-6);
    EXPECT_EQ(front.handedness, 1);
}

TEST_F(Spheres, NearestOfManyIsHitWhateverTheTree) {
    RandomNumbers random(5);
    std::vector<Shape> shapes;
    for (int i = 0; i < 500; ++i)
        shapes.push_back(
            sphereOf(glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)),
                     random.between(0.01f, 0.1f)));
    ShapeProbe probe(device, shapes);
    std::vector<TestRay> rays;
    for (int i = 0; i < 20'000; ++i) {
        TestRay ray;
        ray.origin = glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        ray.direction = random.direction();
        rays.push_back(ray);
    }
    const auto hits = probe.trace(rays);
    size_t wrong = 0, found = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        double best = std::numeric_limits<double>::infinity(), margin = 1;
        for (const Shape& shape : shapes) {
            TestRay moved = rays[i];
            moved.origin -= glm::vec3(glm::dvec3(shape.toWorld[3]) - probe.centre());
            const Exact exact = exactCrossings(moved, shape.size.x);
            margin = std::min(margin, std::abs(static_cast<double>(exact.impact) - shape.size.x));
            margin = std::min(margin, std::abs(glm::length(glm::dvec3(moved.origin)) - shape.size.x));
            const double t = static_cast<double>(exact.near > 0 ? exact.near : exact.far);
            if (exact.any && t > 0) best = std::min(best, t);
        }
        if (margin < 1e-5) continue;
        found += !hits[i].missed();
        if (hits[i].missed() != std::isinf(best) || (!hits[i].missed() && std::abs(hits[i].t - best) > 1e-4))
            ++wrong;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(found, 8'000u);
}

}  // namespace
}  // namespace tilefarm
