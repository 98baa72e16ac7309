#pragma once

#include <glm/glm.hpp>

#include "worker/scene/world.h"

namespace tilefarm {

/// Share of a surface that is there where its alpha is this: the alpha itself of a blended one, 0 or 1 of a
/// masked one.
double coverageOf(const Material& material, double alpha);

/// Mean over a triangle of what scales its material's emission: emission texture times coverage, from texels
/// and vertex colours at a fixed set of points. Only chooses lights: its error costs noise, never bias.
glm::dvec3 averageEmission(const Scene& scene, const Material& material, const WorldGeometry& world,
                           uint32_t triangle);

}  // namespace tilefarm
