#include "worker/render/host_facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tilefarm {
namespace {

using std::numbers::pi;

double stretch(const glm::dvec3& w, double alpha) {
    return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y));
}

// Smith's Λ of the Beckmann distribution.
double beckmannLambda(const glm::dvec3& w, double alpha) {
    const double s = alpha * std::hypot(w.x, w.y), z = std::abs(w.z);
    if (s == 0) return 0;
    const double a = z / s;
    return std::max(0.5 * (std::exp(-a * a) / (a * std::sqrt(pi)) - std::erfc(a)), 0.0);
}

// That of Phong, with the exact Γ; see phongLambda in shaders/bsdf/beckmann.glsl.
double phongLambda(const glm::dvec3& w, double alpha) {
    const double sinSquared = w.x * w.x + w.y * w.y, z = std::abs(w.z);
    if (alpha < 0.1 || sinSquared == 0) return beckmannLambda(w, alpha);
    const double nu = 2 / (alpha * alpha), logSine = 0.5 * std::log(std::min(sinSquared, 1.0));
    const double gammas = std::exp(std::lgamma((nu + 1) / 2) - std::lgamma(nu / 2)) / std::sqrt(pi);
    const double first = gammas / (nu - 1) * std::exp((nu - 1) * logSine) * std::sqrt(sinSquared) / z;
    const double y = (8 * nu + 1) / (8 * nu + 3) * std::sqrt(std::max(-nu * logSine, 0.0));
    return std::max(first - 0.5 * std::erfc(y), 0.0);
}

// Dupuy, Benyoub 2023, as ggxSampleVisible.
glm::dvec3 visibleNormal(const glm::dvec3& wo, double alpha, double u, double v) {
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * wo.x, alpha * wo.y, wo.z));
    const double phi = 2 * pi * u;
    const double z = (1 - v) * (1 + stretched.z) - stretched.z;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const glm::dvec3 h = glm::dvec3(r * std::cos(phi), r * std::sin(phi), z) + stretched;
    return glm::normalize(glm::dvec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-300)));
}

}  // namespace

double fresnelDielectric(double cosTheta, double eta) {
    if (eta == 1) return 0;
    const double cosSquaredT = 1 - (1 - cosTheta * cosTheta) / (eta * eta);
    if (cosSquaredT <= 0) return 1;
    const double cosT = std::sqrt(cosSquaredT);
    const double parallel = (eta * cosTheta - cosT) / (eta * cosTheta + cosT);
    const double perpendicular = (cosTheta - eta * cosT) / (cosTheta + eta * cosT);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

double fresnelSchlick(double cosTheta, double eta) {
    const double r = (eta - 1) / (eta + 1);
    return eta == 1 ? 0 : fresnelSchlick(r * r, cosTheta, eta);
}

double fresnelSchlick(double f0, double cosTheta, double eta) {
    if (eta < 1) {
        const double cosSquaredT = 1 - (1 - cosTheta * cosTheta) / (eta * eta);
        if (cosSquaredT <= 0) return 1;
        cosTheta = std::sqrt(cosSquaredT);
    }
    return f0 + (1 - f0) * std::pow(1 - cosTheta, 5);
}

bool refracted(const glm::dvec3& wo, const glm::dvec3& h, double eta, glm::dvec3& wi) {
    const double cosine = glm::dot(wo, h);
    const double cosSquaredT = 1 - (1 - cosine * cosine) / (eta * eta);
    if (cosSquaredT <= 0) return false;
    wi = -wo / eta + (cosine / eta - std::sqrt(cosSquaredT)) * h;
    return wi.z < 0;
}

glm::dvec3 HostFacets::sample(const glm::dvec3& wo, double u, double v) const {
    return visibleNormal(wo, alpha, u, v);
}

double HostFacets::weight(const glm::dvec3& wo, const glm::dvec3& wi, const glm::dvec3& h) const {
    const double zo = wo.z, zi = std::abs(wi.z);
    const double so = stretch(wo, alpha);
    if (kind == Microfacets::ggx) return zi * (zo + so) / (zo * stretch(wi, alpha) + zi * so);
    const auto lambda = kind == Microfacets::phong ? phongLambda : beckmannLambda;
    const double shadowing = 1 / (1 + lambda(wo, alpha) + lambda(wi, alpha));
    return distributionRatio(h) * shadowing * (zo + so) / (2 * zo);
}

double HostFacets::distributionRatio(const glm::dvec3& h) const {
    const double a2 = alpha * alpha, z2 = h.z * h.z, sinSquared = h.x * h.x + h.y * h.y;
    const double ggx = std::pow(z2 + sinSquared / a2, 2);  // D of each times π α²
    if (kind == Microfacets::beckmann) return std::exp(-sinSquared / (z2 * a2)) / (z2 * z2) * ggx;
    return std::exp((1 / a2 - 1) * std::log1p(-std::min(sinSquared, 1 - 1e-15))) * ggx;
}

}  // namespace tilefarm
