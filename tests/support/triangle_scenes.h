#pragma once
// Triangle meshes and ray sets for tests and benchmarks of ray intersection. Deterministic.

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

namespace tilefarm {

/// Three corners per triangle.
using Triangles = std::vector<glm::vec3>;

/// Uniform numbers from SplitMix64.
class RandomNumbers {
public:
    explicit RandomNumbers(uint64_t seed) : state_(seed) {}
    uint64_t bits();
    /// In [0, 1).
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    float between(float low, float high) { return low + static_cast<float>(unit()) * (high - low); }
    glm::vec3 direction();

private:
    uint64_t state_;
};

/// Longitude-latitude sphere of 2 * (rings - 1) * segments triangles. `radius(i, j)` per vertex; the poles
/// and the seam share their vertices, so it is closed.
Triangles sphereMesh(glm::vec3 centre, float radius, uint32_t rings, uint32_t segments);
Triangles bumpySphere(float least, float most, uint32_t rings, uint32_t segments, uint64_t seed);

/// `count` triangles with corners in the cube [-1, 1]³, their edges about `size` long.
Triangles triangleSoup(uint32_t count, float size, uint64_t seed);

/// The unit-cube room with two boxes and a quad below its ceiling: 36 triangles. Open towards +z.
Triangles cornellBox();

/// A closed room whose floor is a displaced grid of 2 * cells² triangles.
Triangles terrain(uint32_t cells);

/// A ray as the trace_rays kernel reads it.
struct TestRay {
    glm::vec3 origin{0};
    float tMin = 0;
    glm::vec3 direction{0, 0, 1};
    float tMax = std::numeric_limits<float>::infinity();
    uint32_t skipPrimitive = 0xffffffffu;
    uint32_t key = 0;
    uint32_t startNormal = 0;
    float startReach = 0;
};
static_assert(sizeof(TestRay) == 48, "three texels of trace_rays.comp");

/// Rays from a pinhole at `eye` towards `target`, one per pixel, in blocks of 8×8 pixels.
std::vector<TestRay> cameraRays(glm::vec3 eye, glm::vec3 target, float tanHalfFov, uint32_t width,
                                uint32_t height);

}  // namespace tilefarm
