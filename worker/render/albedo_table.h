#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace tilefarm {

/// Directional albedo of rough dielectric reflection (GGX, height-correlated Smith, exact Fresnel,
/// single scattering): ∫ f cosθi dωi for cosθo ≥ 0 and roughness α = perceptual roughness². In [0, 1].
/// Stratified quadrature over visible normals in fp64; absolute error ≤ 1e-3 against 16 times the
/// points (tests/unit/worker/render/albedo_table_test.cpp).
double reflectionAlbedo(double cosTheta, double alpha, double ior);

/// A directional albedo of (cosθ, perceptual roughness) as the table that shaders/bsdf/albedo_table.glsl
/// reads: ALBEDO_TABLE_SIZE + 1 rows of ALBEDO_TABLE_SIZE texels.
std::vector<glm::vec4> tabulateAlbedo(const std::function<double(double, double)>& albedo);

/// The table of reflectionAlbedo.
std::vector<glm::vec4> buildAlbedoTable(double ior);

}  // namespace tilefarm
