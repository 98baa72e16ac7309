#include "tests/support/ray_sets.h"

#include <algorithm>

namespace tilefarm {

TestRay rayTowards(glm::vec3 origin, glm::vec3 target) {
    TestRay ray;
    ray.origin = origin;
    ray.direction = glm::normalize(target - origin);
    return ray;
}

std::vector<TestRay> randomRays(uint32_t count, float extent, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<TestRay> rays(count);
    for (TestRay& ray : rays) {
        ray.origin = extent * glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        ray.direction = random.direction();
    }
    return rays;
}

glm::vec3 pointOf(const Triangles& triangles, const TracedHit& hit) {
    const glm::vec3* corner = &triangles[3 * size_t(hit.primitive)];
    const auto [u, v] = std::pair(hit.barycentrics.x, hit.barycentrics.y);
    return (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
}

size_t misses(TraceKernel& kernel, std::span<const TestRay> rays) {
    const auto hits = kernel.trace(rays);
    return static_cast<size_t>(
        std::count_if(hits.begin(), hits.end(), [](auto& hit) { return hit.missed(); }));
}

TracedHit exactHit(const Triangles& triangles, const TestRay& ray) {
    TracedHit best;
    double bestT = ray.tMax;
    for (uint32_t i = 0; i < triangles.size() / 3; ++i) {
        const glm::dvec3 o(ray.origin), d(ray.direction);
        const glm::dvec3 a = glm::dvec3(triangles[3 * i]) - o, b = glm::dvec3(triangles[3 * i + 1]) - o,
                         c = glm::dvec3(triangles[3 * i + 2]) - o;
        const double u = glm::dot(d, glm::cross(c, b)), v = glm::dot(d, glm::cross(a, c)),
                     w = glm::dot(d, glm::cross(b, a)), sum = u + v + w;
        if (sum == 0 || (std::min({u, v, w}) < 0 && std::max({u, v, w}) > 0)) continue;
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double t = glm::dot(a, normal) / glm::dot(d, normal);
        if (t > ray.tMin && (t < bestT || (t == bestT && best.missed()))) {
            bestT = t;
            best.t = static_cast<float>(t);
            best.primitive = i;
        }
    }
    return best;
}

}  // namespace tilefarm
