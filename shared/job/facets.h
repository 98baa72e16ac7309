#pragma once

#include <cstdint>

namespace tilefarm {

/// Distribution of microfacet normals.
enum class Microfacets : uint8_t { ggx, beckmann, phong };

/// How the reflectance of dielectrics is computed.
enum class Fresnel : uint8_t { exact, schlick };

}  // namespace tilefarm
