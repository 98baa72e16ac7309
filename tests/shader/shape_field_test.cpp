// Hard case 53: sphere tracing from inside, from the surface and just off it, along it, and where the field
// lies.
#include <algorithm>
#include <cmath>

#include "tests/shader/device_fixture.h"
#include "tests/shader/shape_probe.h"
#include "tests/support/shape_oracle.h"

namespace tilefarm {
namespace {

class Fields : public DeviceTest {};

FieldInstruction of(FieldOperation operation, glm::dvec4 parameters, glm::dvec3 translation = glm::dvec3(0)) {
    return {operation, parameters, translation, {0, 0, 0, 1}};
}

Shape ball() {
    return fieldOf({of(FieldOperation::sphere, {1, 0, 0, 0})});
}

TestRay rayAt(const glm::dvec3& origin, const glm::dvec3& direction) {
    TestRay ray;
    ray.origin = origin;
    ray.direction = glm::normalize(direction);
    return ray;
}

TEST_F(Fields, HardCase53_RaysThatStartAtTheSurfaceGoWhereTheyShould) {
    ShapeProbe probe(device, {ball()});
    RandomNumbers random(1);
    std::vector<TestRay> in, out, within;
    for (int i = 0; i < 5'000; ++i) {
        const glm::dvec3 n(random.direction());
        glm::dvec3 d(random.direction());
        if (glm::dot(d, n) < 0) d = -d;
        if (glm::dot(d, n) < 0.05) d += 0.1 * n;
        const double off = i % 3 == 0 ? 1e-6 : i % 3 == 1 ? 0.0 : 1e-4;
        out.push_back(rayAt((1 + off) * n, d));
        in.push_back(rayAt((1 + off) * n, -d));
        within.push_back(rayAt((1 - 1e-4 - 0.9 * random.unit()) * n, d));
    }
    const auto outwards = probe.trace(out), inwards = probe.trace(in), inside = probe.trace(within);
    for (size_t i = 0; i < in.size(); ++i) {
        const glm::dvec3 o(in[i].origin), d(in[i].direction);
        // At 0 and 1e-6 the float's rounding decides on which side the ray starts; both ways are right there.
        const bool clearlyOff = i % 3 == 2;
        if (clearlyOff) {
            EXPECT_TRUE(outwards[i].missed()) << i;
        } else if (!outwards[i].missed()) {
            EXPECT_LT(outwards[i].t, 1e-3) << i;
        }
        ASSERT_FALSE(inwards[i].missed()) << i;
        const double middle = -glm::dot(o, d),
                     half = std::sqrt(std::max(0.0, middle * middle - glm::dot(o, o) + 1));
        const double t = inwards[i].t;
        EXPECT_LT(std::min(std::abs(t - (middle - half)), std::abs(t - (middle + half))), 2e-4) << i;
        if (clearlyOff) {
            EXPECT_LT(t, middle);
        }
        ASSERT_FALSE(inside[i].missed()) << i;
        EXPECT_LT(std::abs(glm::length(glm::dvec3(inside[i].position)) - 1), 1e-6) << i;
    }
}

// Rays parallel to a box's face, from far below to far above its plane, and tangents of a sphere.
TEST_F(Fields, HardCase53_GrazingRaysEndAndHardlyEverMiss) {
    const Shape block = fieldOf({of(FieldOperation::box, {1, 1, 1, 0})});
    size_t wrong = 0, total = 0;
    for (const Shape& shape : {ball(), block}) {
        ShapeProbe probe(device, {shape});
        RandomNumbers random(2);
        std::vector<TestRay> rays;
        for (int i = 0; i < 1'500; ++i) {
            const glm::dvec3 n = shape.field[0].operation == FieldOperation::box
                                     ? glm::dvec3(0, 1, 0)
                                     : glm::dvec3(random.direction());
            const glm::dvec3 side = glm::normalize(glm::cross(n, glm::dvec3(random.direction())));
            const double off = (random.bits() & 1 ? 1 : -1) * std::pow(10.0, random.between(-6, -1));
            rays.push_back(rayAt((1 + off) * n - 3.0 * side, side));
        }
        const auto hits = probe.trace(rays);
        for (size_t i = 0; i < rays.size(); ++i) {
            const ExactShapeHit exact = exactHit(shape, rays[i].origin, rays[i].direction);
            ++total;
            // Within 1e-4 of the size, 3.5e-4, of the surface a hit and a miss are as good; a ray that goes
            // no deeper into the ball meets it at a cosine of √(2 · 3.5e-4).
            wrong += hits[i].missed() == exact.hit &&
                     (exact.hit ? std::abs(glm::dot(exact.normal, glm::dvec3(rays[i].direction))) > 0.026
                                : exact.nearest > 3.5e-4);
            if (!hits[i].missed()) {
                EXPECT_LT(std::abs(exactDistance(shape, hits[i].position)), 2e-4);
            }
        }
    }
    EXPECT_LE(wrong, total / 1000);
}

// Where a box stands on a box, and a sphere in it: no ray gets in between.
TEST_F(Fields, HardCase53_NoHoleWherePrimitivesMeet) {
    const Shape shape = fieldOf(
        {of(FieldOperation::box, {1, 0.5, 1, 0}, {0, -0.5, 0}),
         of(FieldOperation::box, {1, 0.5, 1, 0}, {0, 0.5, 0}), of(FieldOperation::unite, {0, 0, 0, 0}),
         of(FieldOperation::sphere, {0.5, 0, 0, 0}, {1, 0, 0}), of(FieldOperation::unite, {0, 0, 0, 0})});
    ShapeProbe probe(device, {shape});
    RandomNumbers random(3);
    std::vector<TestRay> rays;
    for (int i = 0; i < 20'000; ++i) {
        // At the seam y = 0 of the face x = −1, from everywhere before it.
        const glm::dvec3 target(-1, i % 2 ? 0.0 : random.between(-1e-5f, 1e-5f),
                                random.between(-0.99f, 0.99f));
        const glm::dvec3 from(random.between(-4, -1.2f), random.between(-2, 2), random.between(-2, 2));
        rays.push_back(rayAt(from, target - from));
    }
    const auto hits = probe.trace(rays);
    size_t holes = 0;
    for (const ShapeHit& hit : hits) holes += hit.missed() || std::abs(hit.position.x + 1) > 1e-4;
    EXPECT_EQ(holes, 0u);
}

// The fractal's estimate is no distance, nor is it continuous: every ray ends, and what it hits is the
// surface.
TEST_F(Fields, HardCase53_AFieldThatIsNoDistanceTerminates) {
    const Shape shape = fieldOf({of(FieldOperation::mandelbulb, {8, 8, 0, 0})});
    ShapeProbe probe(device, {shape});
    RandomNumbers random(4);
    std::vector<TestRay> rays;
    for (int i = 0; i < 4'000; ++i) {
        const glm::dvec3 from = 3.0 * glm::dvec3(random.direction()),
                         target = 0.9 * random.unit() * glm::dvec3(random.direction());
        rays.push_back(rayAt(from, target - from));
    }
    const auto hits = probe.trace(rays);
    size_t found = 0, off = 0, holes = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const glm::dvec3 d(rays[i].direction), o(rays[i].origin);
        if (hits[i].missed()) {
            // All of the ball of radius 0.6 is inside.
            const double t = -glm::dot(o, d);
            holes += glm::length(o + t * d) < 0.6;
            continue;
        }
        ++found;
        ASSERT_TRUE(std::isfinite(hits[i].normal.x + hits[i].normal.y + hits[i].normal.z));
        // Within 1e-4 of the size, along the ray, the side changes.
        const glm::dvec3 p = o + double(hits[i].t) * d;
        double least = 1e9, most = -1e9;
        for (int k = -8; k <= 8; ++k) {
            const double at = exactDistance(shape, p + 4e-5 * k * d);
            least = std::min(least, at);
            most = std::max(most, at);
        }
        off += least > 1e-4 || most < -1e-4;
    }
    EXPECT_GT(found, rays.size() / 2);
    EXPECT_EQ(holes, 0u);
    EXPECT_LE(off, found / 1000);
}

}  // namespace
}  // namespace tilefarm
