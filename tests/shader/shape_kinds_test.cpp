// Every kind of shape against double precision: hit or miss, t, position, normal, texture coordinates.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/shader/device_fixture.h"
#include "tests/shader/shape_probe.h"
#include "tests/support/shape_oracle.h"

namespace tilefarm {
namespace {

FieldInstruction primitive(FieldOperation operation, glm::dvec4 parameters,
                           glm::dvec3 translation = glm::dvec3(0)) {
    return {operation, parameters, translation, {0, 0, 0, 1}};
}

FieldInstruction combine(FieldOperation operation, double smooth = 0) {
    return {operation, {smooth, 0, 0, 0}, glm::dvec3(0), {0, 0, 0, 1}};
}

using enum FieldOperation;

struct Kind {
    const char* name;
    Shape shape;
    double edges = 0;  // share of hits that may be so near an edge that its normal is the other face's
};

void PrintTo(const Kind& kind, std::ostream* out) {
    *out << kind.name;
}

const double kTurn = std::sin(0.4), kStay = std::cos(0.4);

std::vector<Kind> kinds() {
    FieldInstruction leaning = primitive(box, {0.5, 0.3, 0.4, 0.1}, {0.2, 0.3, 0});
    leaning.rotation = {0, 0, kTurn, kStay};
    return {
        {"Sphere", shapeOf(ShapeKind::sphere, glm::dvec3(0.8))},
        {"Box", shapeOf(ShapeKind::box, {0.5, 1, 0.25})},
        {"Rectangle", shapeOf(ShapeKind::rectangle, {1, 0.5, 0})},
        {"Disk", shapeOf(ShapeKind::disk, {0.8, 0, 0})},
        {"Cylinder", shapeOf(ShapeKind::cylinder, {0.7, 0.5, 0.5})},
        {"Frustum", shapeOf(ShapeKind::cylinder, {0.7, 0.8, 0.3})},
        {"Cone", shapeOf(ShapeKind::cylinder, {0.7, 0.9, 0})},
        {"SteepCone", shapeOf(ShapeKind::cylinder, {0.1, 0, 1})},
        {"Capsule", shapeOf(ShapeKind::capsule, {0.5, 0.4, 0.4})},
        {"TaperedCapsule", shapeOf(ShapeKind::capsule, {0.6, 0.5, 0.2})},
        {"FieldSphere", fieldOf({primitive(sphere, {0.9, 0, 0, 0})})},
        {"FieldBox", fieldOf({primitive(box, {0.5, 0.8, 0.3, 0})})},
        {"FieldRoundedBox", fieldOf({leaning})},
        {"FieldTorus", fieldOf({primitive(torus, {0.7, 0.25, 0, 0})})},
        {"FieldCone", fieldOf({primitive(cone, {0.6, 0.7, 0.2, 0})})},
        {"FieldUnion", fieldOf({primitive(sphere, {0.5, 0, 0, 0}, {-0.4, 0, 0}),
                                primitive(box, {0.4, 0.4, 0.4, 0}, {0.4, 0, 0}), combine(unite)})},
        {"FieldSmoothUnion",
         fieldOf({primitive(sphere, {0.5, 0, 0, 0}, {-0.4, 0, 0}),
                  primitive(sphere, {0.4, 0, 0, 0}, {0.5, 0.2, 0}), combine(unite, 0.3)})},
        {"FieldIntersection", fieldOf({primitive(sphere, {0.8, 0, 0, 0}), primitive(box, {0.6, 0.6, 0.6, 0}),
                                       combine(intersect, 0.1)})},
        {"FieldDifference", fieldOf({primitive(box, {0.6, 0.6, 0.6, 0}), primitive(sphere, {0.75, 0, 0, 0}),
                                     combine(subtract, 0.05)})},
    };
}

std::vector<TestRay> raysAround(const Shape& shape, const glm::dvec3& centre, uint32_t count, uint64_t seed) {
    const ShapeBounds bounds = boundsOf(shape);
    const glm::dvec3 middle = 0.5 * (bounds.lower + bounds.upper), half = 0.5 * (bounds.upper - bounds.lower);
    const double size = glm::length(half);
    RandomNumbers random(seed);
    std::vector<TestRay> rays(count);
    for (TestRay& ray : rays) {
        const glm::dvec3 in = glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        const bool fromWithin = random.bits() % 4 == 0 && half.z > 0;
        const glm::dvec3 from =
            fromWithin ? middle + half * in : middle + 3 * size * glm::dvec3(random.direction());
        const glm::dvec3 in2(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        ray.origin = from - centre;
        ray.direction =
            fromWithin ? random.direction() : glm::vec3(glm::normalize(middle + half * in2 - from));
    }
    return rays;
}

class ShapeKinds : public DeviceTest, public testing::WithParamInterface<Kind> {};

struct Tally {
    size_t hits = 0, disputed = 0, wrong = 0, offT = 0, offPosition = 0, offNormal = 0, notFinite = 0;
};

Tally compare(const Shape& shape, const glm::dvec3& centre, std::span<const TestRay> rays,
              std::span<const ShapeHit> hits) {
    const ShapeBounds bounds = boundsOf(shape);
    const double size = glm::length(bounds.upper - bounds.lower);
    // Sphere tracing converges the slower the lower the ray comes in; hard case 53 allows to lose 1e-3 of the
    // rays.
    const double grazing = shape.kind == ShapeKind::field ? 2e-2 : 3e-3;
    // Where a crease is smoothed its radius is some 1e-3 of the size, and a field is met within 1e-6 of it.
    const double sharp = shape.kind == ShapeKind::field ? 5e-4 : 1e-4;
    Tally tally;
    for (size_t i = 0; i < rays.size(); ++i) {
        const ExactShapeHit exact = exactHit(shape, glm::dvec3(rays[i].origin) + centre, rays[i].direction);
        if (exact.hit == hits[i].missed()) {
            // Only a ray that grazes, or starts on the surface, may be told otherwise.
            const glm::dvec3 d(rays[i].direction);
            const bool grazes = exact.hit ? std::abs(glm::dot(exact.normal, glm::normalize(d))) < grazing
                                          : exact.nearest < 1e-5 * size;
            ++tally.disputed;
            tally.wrong += !grazes && exact.t > 1e-5 * size;
            continue;
        }
        if (!exact.hit) continue;
        ++tally.hits;
        const double cosine = std::abs(glm::dot(exact.normal, glm::normalize(glm::dvec3(rays[i].direction))));
        const double allowed = 1e-5 * size / std::max(cosine, 1e-3);
        if (std::abs(hits[i].t - exact.t) > allowed) {
            ++tally.offT;
            continue;
        }
        const glm::dvec3 p = glm::dvec3(hits[i].position) + centre;
        if (glm::distance(p, exact.position) > 2 * allowed) ++tally.offPosition;
        if (glm::length(glm::cross(glm::dvec3(hits[i].normal), exact.normal)) >
                sharp / std::max(cosine, 1e-2) ||
            glm::dot(glm::dvec3(hits[i].normal), exact.normal) < 0)
            ++tally.offNormal;
        const glm::vec3 all = hits[i].position + hits[i].normal + hits[i].error + hits[i].tangent;
        const bool inRange =
            hits[i].u >= -1e-5f && hits[i].u <= 1.00001f && hits[i].v >= -1e-5f && hits[i].v <= 1.00001f;
        if (!std::isfinite(all.x + all.y + all.z) || !inRange) ++tally.notFinite;
    }
    return tally;
}

glm::dmat4 placed() {
    return glm::translate(glm::dmat4(1), glm::dvec3(3, -2, 7)) *
           glm::rotate(glm::dmat4(1), 0.8, glm::normalize(glm::dvec3(1, -2, 0.5))) *
           glm::scale(glm::dmat4(1), glm::dvec3(2.5));
}

TEST_P(ShapeKinds, EqualDoublePrecision) {
    for (const glm::dmat4& toWorld : {glm::dmat4(1), placed()}) {
        Shape shape = GetParam().shape;
        shape.toWorld = toWorld;
        ShapeProbe probe(device, {shape});
        const auto rays = raysAround(shape, probe.centre(), 3'000, 7);
        const Tally tally = compare(shape, probe.centre(), rays, probe.trace(rays));
        EXPECT_EQ(tally.wrong, 0u);
        EXPECT_LE(tally.disputed, rays.size() / 1000);
        EXPECT_EQ(tally.offT, 0u);
        EXPECT_EQ(tally.offPosition, 0u);
        // An edge, rounded by 1e-5 of the size, belongs to either side.
        EXPECT_LE(tally.offNormal, 3u);
        EXPECT_EQ(tally.notFinite, 0u);
        EXPECT_GT(tally.hits, 450u);
    }
}

// A ray that goes on from a hit meets what double precision says it meets; one that goes back meets nothing
// at once.
TEST_P(ShapeKinds, RaysThatStartOnThemGoWhereTheyShould) {
    Shape shape = GetParam().shape;
    shape.toWorld = placed();
    ShapeProbe probe(device, {shape});
    const auto rays = raysAround(shape, probe.centre(), 1'500, 8);
    const auto hits = probe.trace(rays);
    const bool flat = shape.kind == ShapeKind::rectangle || shape.kind == ShapeKind::disk;
    const ShapeBounds bounds = boundsOf(shape);
    const double size = glm::length(bounds.upper - bounds.lower);
    size_t wrong = 0, stuck = 0, tested = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const glm::dvec3 d(rays[i].direction), n(hits[i].normal);
        if (std::abs(glm::dot(n, d)) < 0.05) continue;
        ++tested;
        const glm::dvec3 from = glm::dvec3(hits[i].position) + probe.centre() + 2e-5 * size * d;
        const ExactShapeHit next = flat ? ExactShapeHit{} : exactHit(shape, from, d);
        const double expected = next.t + 2e-5 * size;
        const double cosine = next.hit ? std::abs(glm::dot(next.normal, d)) : 1;
        const bool same = next.hit ? hits[i].nextForwards > 0 &&
                                         std::abs(hits[i].nextForwards - expected) < 1e-4 * size / cosine
                                   : hits[i].nextForwards < 0;
        // Past an edge, or along the surface, a little of position decides.
        wrong += !same && next.nearest > 1e-4 * size && cosine > 0.05;
        stuck += hits[i].nextBack >= 0 && hits[i].nextBack < 1e-4 * hits[i].t;
    }
    EXPECT_GT(tested, 180u);
    EXPECT_LE(wrong, tested / 500);  // within 1e-4 of an edge
    EXPECT_EQ(stuck, 0u);
}

TEST_P(ShapeKinds, TexturesFollowTheTangent) {
    const Shape& shape = GetParam().shape;
    ShapeProbe probe(device, {shape});
    const auto rays = raysAround(shape, probe.centre(), 2'000, 9);
    const auto hits = probe.trace(rays);
    std::vector<TestRay> beside;
    std::vector<size_t> of;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed() || std::abs(glm::dot(hits[i].normal, rays[i].direction)) < 0.2f) continue;
        EXPECT_NEAR(glm::dot(hits[i].tangent, hits[i].normal), 0, 1e-4);
        EXPECT_NEAR(glm::length(hits[i].tangent), 1, 1e-4);
        TestRay ray = rays[i];
        ray.origin += 0.01f * hits[i].tangent;
        beside.push_back(ray);
        of.push_back(i);
    }
    const auto neighbours = probe.trace(beside);
    size_t against = 0, tested = 0;
    for (size_t k = 0; k < beside.size(); ++k) {
        const ShapeHit& hit = hits[of[k]];
        // On the same smooth piece, away from the seam.
        if (neighbours[k].missed() || glm::dot(neighbours[k].normal, hit.normal) < 0.95f || hit.u > 0.97f)
            continue;
        if (glm::distance(neighbours[k].position, hit.position) > 0.05f ||
            std::abs(neighbours[k].u - hit.u) > 0.5f)
            continue;
        ++tested;
        against += neighbours[k].u < hit.u - 1e-5f;
    }
    EXPECT_GT(tested, 100u);
    EXPECT_LE(against, tested / 50);
}

INSTANTIATE_TEST_SUITE_P(Every, ShapeKinds, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace tilefarm
