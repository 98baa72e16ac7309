#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace tilefarm {

/// Directional albedo of the Charlie sheen of shaders/bsdf/sheen.glsl with white colour, before that file's
/// division keeps it at 1 or below: ∫ f cosθi dωi. Above 1 for small roughness at grazing angles. Quadrature
/// in fp64; relative error ≤ 5e-3 against 16 times the points
/// (tests/unit/worker/render/layer_tables_test.cpp).
double sheenAlbedo(double cosTheta, double roughness);

/// Directional albedo of Disney's clearcoat, shaders/bsdf/gtr1.glsl, with the exact Fresnel term of
/// index 1.5; absolute error ≤ 1e-3, likewise.
double gtr1Albedo(double cosTheta, double alpha);

/// The tables of both, as tabulateAlbedo lays them out; that of sheen times the roughness, which is nearly
/// constant where the albedo varies most, and in rows by the root of the roughness above the least one, which
/// gives small ones the rows that they need.
std::vector<glm::vec4> buildSheenTable();
std::vector<glm::vec4> buildGtr1Table();

}  // namespace tilefarm
