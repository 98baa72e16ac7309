#pragma once

#include <glm/glm.hpp>

#include "shared/job/facets.h"

/// Microfacets in fp64 for the quadrature of albedos: shaders/bsdf/{fresnel,facets}.glsl on the host.
namespace tilefarm {

double fresnelDielectric(double cosTheta, double eta);
double fresnelSchlick(double cosTheta, double eta);
/// The same with another reflectance at normal incidence.
double fresnelSchlick(double f0, double cosTheta, double eta);

/// Direction of wo refracted at h; false where it is reflected totally or would leave on wo's side.
bool refracted(const glm::dvec3& wo, const glm::dvec3& h, double eta, glm::dvec3& wi);

struct HostFacets {
    Microfacets kind = Microfacets::ggx;
    double alpha = 0.5;

    /// One of GGX's visible normals, whatever the distribution, as facetSample. u, v in (0, 1).
    glm::dvec3 sample(const glm::dvec3& wo, double u, double v) const;
    /// Unit-reflectance BSDF times cosine over the density of wi by way of `sample`: of reflection, or of
    /// refraction times eta², whichever wi is.
    double weight(const glm::dvec3& wo, const glm::dvec3& wi, const glm::dvec3& h) const;

private:
    double distributionRatio(const glm::dvec3& h) const;  // D over GGX's
};

}  // namespace tilefarm
