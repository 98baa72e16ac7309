// Traversal against Embree and against double precision.

#include <algorithm>
#include <cmath>

#include "tests/shader/device_fixture.h"
#include "tests/support/embree_oracle.h"
#include "tests/support/ray_sets.h"
#include "tests/support/trace_kernel.h"

namespace tilefarm {
namespace {

class Traversal : public DeviceTest {};

// At corners and at the middles of edges: where hit and miss are decided by the last bit.
std::vector<TestRay> aimedRays(const Triangles& triangles, uint32_t count, float extent, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<TestRay> rays = randomRays(count, extent, seed + 1);
    for (TestRay& ray : rays) {
        const size_t first = random.bits() % (triangles.size() / 3) * 3, corner = random.bits() % 3;
        const glm::vec3 a = triangles[first + corner], b = triangles[first + (corner + 1) % 3];
        ray = rayTowards(ray.origin, random.bits() & 1 ? a : 0.5f * (a + b));
    }
    return rays;
}

// How far from the triangle's outline a ray passes, in double.
double distanceToOutline(const glm::vec3* corner, const TestRay& ray) {
    const glm::dvec3 d(ray.direction);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        // Seen along the ray, which is a point at the origin then: of a segment the nearest point.
        const auto seen = [&](const glm::vec3& at) {
            const glm::dvec3 to = glm::dvec3(at) - glm::dvec3(ray.origin);
            return to - glm::dot(to, d) / glm::dot(d, d) * d;
        };
        const glm::dvec3 a = seen(corner[i]), b = seen(corner[(i + 1) % 3]), along = b - a;
        const double length = glm::dot(along, along);
        const double s = length > 0 ? glm::clamp(-glm::dot(a, along) / length, 0.0, 1.0) : 0;
        least = std::min(least, glm::length(a + s * along));
    }
    return least;
}

// Some roundings of coordinates up to 2.
constexpr double kOnEdge = 1e-6;

struct Agreement {
    size_t equal = 0, ties = 0, onEdges = 0, wrong = 0;
};

// A ray past an edge may hit or miss the triangle; Embree and the kernel need not agree on that, but on all
// else.
Agreement compare(const Triangles& triangles, std::span<const TestRay> rays,
                  std::span<const TracedHit> ours) {
    const std::vector<OracleHit> theirs = EmbreeOracle(triangles).closest(rays);
    Agreement result;
    for (size_t i = 0; i < rays.size(); ++i) {
        const bool sameT = std::abs(ours[i].t - theirs[i].t) <= 2e-5f * (1 + std::abs(theirs[i].t));
        if (ours[i].primitive == theirs[i].primitive && sameT) {
            ++result.equal;
        } else if (!ours[i].missed() && theirs[i].primitive != kMissed && sameT) {
            ++result.ties;
        } else {
            const bool oursNearer =
                theirs[i].primitive == kMissed || (!ours[i].missed() && ours[i].t < theirs[i].t);
            const uint32_t disputed = oursNearer ? ours[i].primitive : theirs[i].primitive;
            const bool onEdge = distanceToOutline(&triangles[3 * size_t(disputed)], rays[i]) < kOnEdge;
            ++(onEdge ? result.onEdges : result.wrong);
        }
    }
    return result;
}

// Random rays hardly ever meet an edge; aimed ones all do, where only ties and disputes at open edges may
// differ.
void expectAgreement(const gpu::Device& device, const Triangles& triangles, std::span<const TestRay> random,
                     std::span<const TestRay> aimed) {
    TraceKernel kernel(device, triangles);
    const Agreement onRandom = compare(triangles, random, kernel.trace(random));
    EXPECT_EQ(onRandom.wrong, 0u);
    EXPECT_LE(onRandom.onEdges + onRandom.ties, random.size() / 2000) << "of " << random.size();
    const Agreement onAimed = compare(triangles, aimed, kernel.trace(aimed));
    EXPECT_EQ(onAimed.wrong, 0u);
}

TEST_F(Traversal, AgreesWithEmbreeOnASphere) {
    const Triangles sphere = sphereMesh(glm::vec3(0), 1, 128, 256);
    auto random = randomRays(100'000, 1.5f, 1);
    const auto camera = cameraRays({0, 0, 4}, {0, 0, 0}, 0.3f, 256, 256);
    random.insert(random.end(), camera.begin(), camera.end());
    expectAgreement(device, sphere, random, aimedRays(sphere, 200'000, 1.5f, 2));
}

TEST_F(Traversal, AgreesWithEmbreeOnTriangleSoup) {
    const Triangles soup = triangleSoup(20'000, 0.05f, 3);
    expectAgreement(device, soup, randomRays(150'000, 1.2f, 4), aimedRays(soup, 150'000, 1.2f, 5));
}

TEST_F(Traversal, AgreesWithEmbreeOnATerrain) {
    const Triangles ground = terrain(200);
    auto random = randomRays(150'000, 0.99f, 6);
    const auto camera = cameraRays({0, 0.3f, 0.95f}, {0, -0.35f, 0}, 0.8f, 256, 256);
    random.insert(random.end(), camera.begin(), camera.end());
    expectAgreement(device, ground, random, aimedRays(ground, 150'000, 0.99f, 7));
}

TEST_F(Traversal, FullAgreesWithEmbreeOnAMillionTriangles) {
    const Triangles ground = terrain(708);
    expectAgreement(device, ground, randomRays(1'000'000, 0.99f, 8), aimedRays(ground, 1'000'000, 0.99f, 9));
}

TEST_F(Traversal, AnyHitHitsWhereClosestHitDoes) {
    const Triangles soup = triangleSoup(5'000, 0.05f, 10);
    auto rays = aimedRays(soup, 100'000, 1.2f, 11);
    for (size_t i = 0; i < rays.size(); i += 2) rays[i].tMax = 0.4f;
    const auto closest = TraceKernel(device, soup).trace(rays);
    const auto any = TraceKernel(device, soup, {.anyHit = true}).trace(rays);
    size_t hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(any[i].missed(), closest[i].missed()) << i;
        hits += !any[i].missed();
    }
    EXPECT_GT(hits, rays.size() / 4);
    EXPECT_LT(hits, rays.size());
}

TEST_F(Traversal, HitPointsFollowFromBarycentrics) {
    const Triangles soup = triangleSoup(5'000, 0.1f, 12);
    const auto rays = randomRays(50'000, 1.0f, 13);
    const auto hits = TraceKernel(device, soup).trace(rays);
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const glm::vec3 byDistance = rays[i].origin + hits[i].t * rays[i].direction;
        ASSERT_LT(glm::distance(pointOf(soup, hits[i]), byDistance), 2e-5f) << i;
        const glm::vec2 weight = hits[i].barycentrics;
        ASSERT_GE(std::min({weight.x, weight.y, 1 - weight.x - weight.y}), -1e-6f);
    }
}

TEST_F(Traversal, TiesGoToTheLowestIndex) {
    // Sixty copies of a fan of six triangles around a vertex, every one hit at the same t by a ray at the
    // vertex.
    Triangles triangles;
    for (int copy = 0; copy < 60; ++copy)
        for (int i = 0; i < 6; ++i) {
            const auto rim = [](int k) { return glm::vec3(k % 3 - 1, (k + 1) / 3 * 2 - 1, 0) * 1.0f; };
            triangles.insert(triangles.end(), {glm::vec3(0), rim(i), rim((i + 1) % 6)});
        }
    TraceKernel kernel(device, triangles);
    TestRay ray;
    ray.origin = {0, 0, -1};
    const TracedHit hit = kernel.trace(ray);
    EXPECT_EQ(hit.primitive, exactHit(triangles, ray).primitive);
    EXPECT_EQ(hit.t, 1.0f);
    // Not for rays that graze: their t is off by more than what boxes are tested with in reserve.
    auto aimed = aimedRays(triangles, 4000, 0.5f, 20);
    std::erase_if(aimed, [](const TestRay& each) { return std::abs(each.direction.z) < 0.1f; });
    ASSERT_GT(aimed.size(), 1000u);
    for (const TracedHit& each : kernel.trace(aimed)) EXPECT_TRUE(each.missed() || each.primitive < 6);
}

TEST_F(Traversal, ResultsDoNotDependOnTheOrderOfTriangles) {
    const Triangles ground = terrain(40);
    Triangles reversed;
    const size_t count = ground.size() / 3;
    for (size_t i = count; i-- > 0;) reversed.insert(reversed.end(), &ground[3 * i], &ground[3 * i] + 3);
    const auto rays = randomRays(50'000, 0.9f, 21);
    const auto a = TraceKernel(device, ground).trace(rays), b = TraceKernel(device, reversed).trace(rays);
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(a[i].t, b[i].t);
        ASSERT_EQ(a[i].missed(), b[i].missed());
        if (a[i].missed()) continue;
        ASSERT_EQ(a[i].primitive, count - 1 - b[i].primitive);
    }
}

TEST_F(Traversal, TheSkippedPrimitiveIsNotHit) {
    const Triangles box = cornellBox();
    TraceKernel kernel(device, box);
    RandomNumbers random(22);
    std::vector<TestRay> rays;
    for (uint32_t i = 0; i < 20'000; ++i) {
        const uint32_t primitive = i % uint32_t(box.size() / 3);
        const glm::vec3* corner = &box[3 * primitive];
        const float u = random.between(0.1f, 0.4f), v = random.between(0.1f, 0.4f);
        TestRay ray;
        ray.origin = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        ray.direction = random.direction();
        ray.skipPrimitive = primitive;
        rays.push_back(ray);
    }
    const auto hits = kernel.trace(rays);
    for (size_t i = 0; i < rays.size(); ++i) ASSERT_NE(hits[i].primitive, rays[i].skipPrimitive);
}

TEST_F(Traversal, TheIntervalIsOpenBelowAndClosedAbove) {
    const Triangles wall{{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}};
    TraceKernel kernel(device, wall);
    const auto hits = [&](float tMin, float tMax, float length) {
        TestRay ray;
        ray.direction = {0, 0, length};
        ray.tMin = tMin, ray.tMax = tMax;
        return !kernel.trace(ray).missed();
    };
    EXPECT_TRUE(hits(0, 2, 1));
    EXPECT_FALSE(hits(0, std::nextafter(2.0f, 0.0f), 1));
    EXPECT_FALSE(hits(2, 3, 1));
    EXPECT_TRUE(hits(std::nextafter(2.0f, 0.0f), 3, 1));
    EXPECT_TRUE(hits(0, 0.5f, 4));  // t counts in the direction's length
    EXPECT_FALSE(hits(0, 0.49f, 4));
}

TEST_F(Traversal, NonOpaqueTrianglesAskTheHookWhateverTheOrder) {
    const Triangles soup = triangleSoup(300, 0.5f, 23);
    std::vector<uint8_t> nonOpaque(300);
    for (size_t i = 0; i < nonOpaque.size(); ++i) nonOpaque[i] = i % 3 != 0;
    auto rays = randomRays(5'000, 1.0f, 24);
    for (uint32_t i = 0; i < rays.size(); ++i) rays[i].key = i;
    const auto closest = TraceKernel(device, soup, {.nonOpaque = nonOpaque}).trace(rays);
    const auto any = TraceKernel(device, soup, {.anyHit = true, .nonOpaque = nonOpaque}).trace(rays);
    const auto solid = TraceKernel(device, soup).trace(rays);

    // Peel the solid scene one hit at a time and ask the hook of trace_rays.comp.
    std::vector<TestRay> rest = rays;
    std::vector<TracedHit> expected(rays.size());
    std::vector<bool> settled(rays.size(), false);
    TraceKernel peel(device, soup);
    for (int layer = 0; layer < 40; ++layer) {
        const auto hits = peel.trace(rest);
        for (size_t i = 0; i < rays.size(); ++i) {
            if (settled[i]) continue;
            const auto& hit = hits[i];
            const auto square = glm::uvec2(glm::max(hit.barycentrics, 0.0f) * 8.0f);
            const bool counts = hit.missed() || !nonOpaque[hit.primitive] ||
                                ((square.x + square.y + hit.primitive + rays[i].key) & 1u);
            if (counts) expected[i] = hit, settled[i] = true;
            rest[i].tMin = hit.t;
        }
    }
    size_t different = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(closest[i], expected[i]) << i;
        ASSERT_EQ(any[i].missed(), expected[i].missed()) << i;
        different += closest[i].primitive != solid[i].primitive;
    }
    EXPECT_GT(different, rays.size() / 10);
}

TEST_F(Traversal, NoOneAndHugeTrianglesWork) {
    TestRay ray;
    ray.origin = {0.1f, 0.1f, -5};
    EXPECT_TRUE(TraceKernel(device, Triangles{}).trace(ray).missed());
    EXPECT_TRUE(TraceKernel(device, Triangles{}, {.anyHit = true}).trace(ray).missed());
    const Triangles one{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    EXPECT_EQ(TraceKernel(device, one).trace(ray).t, 5.0f);
    const Triangles huge{{-1e9f, -1e9f, 0}, {1e9f, -1e9f, 0}, {0, 1e9f, 0}};
    EXPECT_NEAR(TraceKernel(device, huge).trace(ray).t, 5.0f, 1e-5f);
    ray.origin = {-5, 0, -1e9f};
    EXPECT_NEAR(TraceKernel(device, huge).trace(ray).t, 1e9f, 1e3f);
}

}  // namespace
}  // namespace tilefarm
