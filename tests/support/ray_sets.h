#pragma once

#include "tests/support/trace_kernel.h"

/// Sets of rays, and what to compare their hits with.
namespace tilefarm {

TestRay rayTowards(glm::vec3 origin, glm::vec3 target);
/// From the cube [-extent, extent]³ in all directions.
std::vector<TestRay> randomRays(uint32_t count, float extent, uint64_t seed);

/// The point of a hit by its barycentrics.
glm::vec3 pointOf(const Triangles& triangles, const TracedHit& hit);
/// How many of the rays hit nothing.
size_t misses(TraceKernel& kernel, std::span<const TestRay> rays);
/// Closest hit in double, edges included, the lowest index at ties. Exact for coordinates of few bits.
TracedHit exactHit(const Triangles& triangles, const TestRay& ray);

}  // namespace tilefarm
