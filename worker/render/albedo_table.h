#pragma once

#include <compare>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "shared/job/facets.h"

namespace tilefarm {

/// What the albedo tables of an interface depend on.
struct InterfaceKind {
    float ior = 1.5f;  // 0: reflects by Schlick's curve from 0 to 1
    Microfacets microfacets = Microfacets::ggx;
    Fresnel fresnel = Fresnel::exact;
    bool solid = false;  // light passes into it and out again
    friend auto operator<=>(const InterfaceKind&, const InterfaceKind&) = default;
};

/// Directional albedos of single scattering, ∫ f cosθi dωi, of the microfacets of
/// shaders/bsdf/facets.glsl; in [0, 1]. By quadrature over normals in fp64; absolute error ≤ 2e-3
/// (tests/unit/worker/render/albedo_table_test.cpp).
struct InterfaceAlbedos {
    double reflected = 0;  // off the dielectric, from outside
    double all = 0;        // off facets that reflect everything
    // From outside and from inside: light reflected and refracted together, radiance times (n_i / n_o)²;
    // and where all is refracted but what is reflected totally.
    double both[2] = {}, clear[2] = {};
};
InterfaceAlbedos interfaceAlbedos(double cosTheta, double alpha, const InterfaceKind& kind);

/// `reflected` of GGX facets with the exact Fresnel term.
double reflectionAlbedo(double cosTheta, double alpha, double ior);

/// A directional albedo of (cosθ, perceptual roughness) as a plain table of
/// shaders/bsdf/albedo_table.glsl: ALBEDO_TABLE_SIZE + 1 rows of ALBEDO_TABLE_SIZE texels. At grazing angles
/// it is nowhere below the albedo in the first `bentRows` cells of roughness, where an interface's lines need
/// it.
std::vector<glm::vec4> tabulateAlbedo(const std::function<double(double, double)>& albedo,
                                      size_t bentRows = 5);

/// The plain table of reflectionAlbedo.
std::vector<glm::vec4> buildAlbedoTable(double ior);

/// The tables of pairs that shaders/bsdf/compensation.glsl reads: (reflected, all); for solids after it
/// (both, clear) from outside and from inside. Built once per process
/// and kind, and kept in gpu::shaderCacheFolder(). Any thread may call.
const std::vector<glm::vec4>& interfaceTables(const InterfaceKind& kind);

/// KHR_materials_dispersion's index for a channel, 0 red to 2 blue, as shaders/material_point.glsl has it.
float dispersedIor(float ior, float dispersion, uint32_t channel);

/// The tables of a solid for red, green and blue one after another, of which a record names those of green.
std::vector<glm::vec4> dispersedTables(const InterfaceKind& solid, float dispersion);
inline constexpr uint32_t kDispersedTablesBeforeNamed = 3;

}  // namespace tilefarm
