// Cases 1, 2, 10, 11, 12: the traversal by itself.

#include <algorithm>
#include <cmath>

#include "tests/numerics/statistics.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/ray_sets.h"

namespace tilefarm {
namespace {

class Traversal : public DeviceTest {};

std::vector<TestRay> raysFromInside(const Triangles& shell, glm::vec3 centre, float spread, uint32_t count) {
    RandomNumbers random(14);
    std::vector<TestRay> rays(count);
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 from = centre + spread * static_cast<float>(random.unit()) * random.direction();
        const size_t corner = i / 4 % shell.size(), first = corner / 3 * 3;  // all four ways at each
        const glm::vec3 a = shell[corner], b = shell[first + (corner + 1) % 3];
        switch (i % 4) {
            case 0: rays[i] = rayTowards(from, a); break;
            case 1: rays[i] = rayTowards(from, 0.5f * (a + b)); break;
            case 2: rays[i] = rayTowards(centre, corner % 2 ? a : 0.5f * (a + b)); break;
            default: rays[i].origin = from, rays[i].direction = random.direction();
        }
    }
    return rays;
}

// Radius 2 at the origin: no ray may get out. At (148376, 1234, −223423) a float is 1/64 apart, so that the
// mesh itself is rough and some of its triangles are slivers.
void expectWatertight(const gpu::Device& device, uint32_t rays) {
    const Triangles sphere = sphereMesh(glm::vec3(0), 2, 64, 128);
    TraceKernel kernel(device, sphere);
    EXPECT_EQ(misses(kernel, raysFromInside(sphere, glm::vec3(0), 1, rays)), 0u);
    const glm::vec3 far(148376, 1234, -223423);
    const Triangles moved = sphereMesh(far, 2, 64, 128);
    TraceKernel farKernel(device, moved);
    const auto escaped = static_cast<double>(misses(farKernel, raysFromInside(moved, far, 1, rays)));
    recordWorst("escaped", escaped);
    EXPECT_LE(escaped, 2e-5 * rays);
}

TEST_F(Traversal, HardCase01_Watertight) {
    expectWatertight(device, 100'000);
}
TEST_F(Traversal, FullHardCase01_Watertight) {
    expectWatertight(device, 1'000'000);
}

TEST_F(Traversal, HardCase02_SpikySphere) {
    const Triangles sphere = bumpySphere(1, 6, 16, 16, 15);
    TraceKernel kernel(device, sphere);
    EXPECT_EQ(misses(kernel, raysFromInside(sphere, glm::vec3(0), 0.2f, 100'000)), 0u);
}

TEST_F(Traversal, HardCase10_Slivers) {
    constexpr int kSlivers = 1000;  // a thousandth of a unit wide and 1000 units long
    const auto corner = [](float x, float z) { return glm::vec3(x, 0.25f * z, z); };
    const auto addStrip = [&](Triangles& to, float left, float right) {
        for (const glm::vec3& at : {corner(left, -500), corner(right, -500), corner(right, 500),
                                    corner(left, -500), corner(right, 500), corner(left, 500)})
            to.push_back(at);
    };
    Triangles quad, slivers;
    addStrip(quad, 0, 1);
    for (int i = 0; i < kSlivers; ++i) addStrip(slivers, float(i) / kSlivers, float(i + 1) / kSlivers);
    RandomNumbers random(16);
    std::vector<TestRay> rays(50'000);
    for (TestRay& ray : rays) {
        const float z = random.between(-490, 490);
        ray = rayTowards({random.between(0, 1), 0.25f * z + 20, z + random.between(-5, 5)},
                         corner(random.between(0.001f, 0.999f), z));
    }
    const auto onQuad = TraceKernel(device, quad).trace(rays),
               onSlivers = TraceKernel(device, slivers).trace(rays);
    double furthest = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_FALSE(onQuad[i].missed());
        ASSERT_FALSE(onSlivers[i].missed()) << i;
        furthest = std::max(furthest,
                            double(glm::distance(pointOf(quad, onQuad[i]), pointOf(slivers, onSlivers[i]))));
    }
    recordWorst("furthest", furthest / 1000);
    EXPECT_LT(furthest, 1e-5 * 1000);
}

// Boxes on a grid: every plane, edge and corner is at a multiple of 1/4.
Triangles blocks() {
    Triangles triangles;
    RandomNumbers random(17);
    for (int block = 0; block < 12; ++block) {
        glm::vec3 low, size;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = 0.25f * float(random.bits() % 24) - 3;
            size[axis] = 0.25f * float(1 + random.bits() % 4);
        }
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const auto corner = [&](int i, int j) {
                    glm::vec3 at = low;
                    at[axis] += side ? size[axis] : 0;
                    at[u] += i ? size[u] : 0;
                    at[v] += j ? size[v] : 0;
                    return at;
                };
                for (const glm::vec3& at :
                     {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 0), corner(1, 1), corner(0, 1)})
                    triangles.push_back(at);
            }
    }
    return triangles;
}

TEST_F(Traversal, HardCase11_AxisParallelRays) {
    const Triangles triangles = blocks();
    TraceKernel kernel(device, triangles);
    std::vector<TestRay> rays;
    for (int axis = 0; axis < 3; ++axis)
        for (float sign : {1.0f, -1.0f})
            for (float zero : {0.0f, -0.0f})
                for (int i = -26; i <= 26; ++i)
                    for (int j = -26; j <= 26; ++j)
                        for (float start : {-4.0f, 0.0f, 0.25f}) {  // from outside, and from planes of boxes
                            TestRay ray;
                            ray.origin[axis] = sign * start;
                            ray.origin[(axis + 1) % 3] = 0.125f * float(i);
                            ray.origin[(axis + 2) % 3] = 0.125f * float(j);
                            ray.direction = glm::vec3(zero);
                            ray.direction[axis] = sign;
                            rays.push_back(ray);
                        }
    const auto hits = kernel.trace(rays);
    size_t found = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const TracedHit exact = exactHit(triangles, rays[i]);
        ASSERT_EQ(hits[i].primitive, exact.primitive) << "ray " << i;
        ASSERT_EQ(hits[i].t, exact.t) << "ray " << i;
        found += !exact.missed();
    }
    EXPECT_GT(found, rays.size() / 20);
}

TEST_F(Traversal, HardCase11_TinyDirectionComponents) {
    const Triangles triangles = blocks();
    TraceKernel kernel(device, triangles);
    std::vector<TestRay> zeros, tiny;
    RandomNumbers random(18);
    for (float component :
         {1e-45f, -1e-45f, 1e-40f, -1e-40f, 1e-37f, -1e-33f, 1e-30f, -1e-25f, 1e-18f, -1e-14f})
        for (int n = 0; n < 3000; ++n) {
            TestRay ray;
            const int axis = n % 3;
            for (int k = 0; k < 3; ++k) ray.origin[k] = 0.0625f + 0.125f * float(random.bits() % 48) - 3;
            ray.direction = glm::vec3(0);
            ray.direction[axis] = n & 1 ? 1.0f : -1.0f;
            zeros.push_back(ray);
            ray.direction[(axis + 1) % 3] = component;
            ray.direction[(axis + 2) % 3] = -component;
            tiny.push_back(ray);
        }
    const auto expected = kernel.trace(zeros), hits = kernel.trace(tiny);
    for (size_t i = 0; i < tiny.size(); ++i) {
        ASSERT_EQ(expected[i].primitive, exactHit(triangles, zeros[i]).primitive) << i;
        ASSERT_EQ(hits[i].primitive, expected[i].primitive) << i;
        ASSERT_NEAR(hits[i].t, expected[i].t, 1e-6f) << i;
    }
}

TEST_F(Traversal, HardCase12_InvalidRays) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    inf = std::numeric_limits<float>::infinity();
    const Triangles ground = terrain(100);
    TraceKernel kernel(device, ground);
    const auto valid = randomRays(100'000, 0.9f, 19);
    std::vector<TestRay> invalid = valid;
    for (size_t i = 0; i < invalid.size(); ++i) {
        TestRay& ray = invalid[i];
        const int axis = static_cast<int>(i / 10 % 3);
        switch (i % 10) {
            case 0: ray.origin[axis] = nan; break;
            case 1: ray.origin[axis] = i & 16 ? inf : -inf; break;
            case 2: ray.direction[axis] = nan; break;
            case 3: ray.direction[axis] = i & 16 ? inf : -inf; break;
            case 4: ray.direction = glm::vec3(i & 16 ? 0.0f : -0.0f); break;
            case 5: ray.direction = glm::vec3(nan); break;
            case 6: ray.tMin = 2, ray.tMax = 1; break;
            case 7: ray.tMin = nan; break;
            case 8: ray.tMax = nan; break;
            case 9: ray.tMax = -1; break;
        }
    }
    double validSeconds = 0, invalidSeconds = 0;
    for (int repeat = 0; repeat < 3; ++repeat) {
        EXPECT_LT(misses(kernel, valid), valid.size() / 4);
        validSeconds += kernel.seconds();
        EXPECT_EQ(misses(kernel, invalid), invalid.size());
        invalidSeconds += kernel.seconds();
    }
    recordWorst("time_ratio", invalidSeconds / validSeconds);
    EXPECT_LT(invalidSeconds, 2.5 * validSeconds);
}

}  // namespace
}  // namespace tilefarm
