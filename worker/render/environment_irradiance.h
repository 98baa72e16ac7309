#pragma once

#include <array>
#include <glm/glm.hpp>

#include "worker/scene/scene.h"

namespace tilefarm {

/// Nine coefficients c from which the irradiance of an environment on a surface with unit normal n (in the
/// environment's own, unrotated axes) is, per channel, in W/m²:
///   c0 + c1 y + c2 z + c3 x + c4 xy + c5 yz + c6 (3z² − 1) + c7 xz + c8 (x² − y²).
/// Spherical harmonics up to l = 2 times the cosine's own (Ramamoorthi and Hanrahan 2001): exact for a
/// constant environment, off by at most 9 % of the maximum for any other, mostly by less than 3 %. The
/// environment is taken as texels of even radiance. Zero without one.
std::array<glm::vec4, 9> environmentIrradiance(const Environment& environment);

}  // namespace tilefarm
