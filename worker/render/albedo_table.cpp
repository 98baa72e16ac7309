#include "worker/render/albedo_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

constexpr int kSize = static_cast<int>(gpu::ALBEDO_TABLE_SIZE);
constexpr int kStrata = 24;  // per dimension of the quadrature

double fresnelDielectric(double cosTheta, double eta) {
    const double cosSquaredT = 1 - (1 - cosTheta * cosTheta) / (eta * eta);
    if (cosSquaredT <= 0) return 1;
    const double cosT = std::sqrt(cosSquaredT);
    const double parallel = (eta * cosTheta - cosT) / (eta * cosTheta + cosT);
    const double perpendicular = (cosTheta - eta * cosT) / (cosTheta + eta * cosT);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

double stretch(const glm::dvec3& w, double alpha) {
    return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y));
}

// As ggxSampleVisible in shaders/bsdf/ggx.glsl.
glm::dvec3 visibleNormal(const glm::dvec3& wo, double alpha, double u, double v) {
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * wo.x, alpha * wo.y, wo.z));
    const double phi = 2 * std::numbers::pi * u;
    const double z = (1 - v) * (1 + stretched.z) - stretched.z;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const glm::dvec3 h = glm::dvec3(r * std::cos(phi), r * std::sin(phi), z) + stretched;
    return glm::normalize(glm::dvec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-300)));
}

double sampleWeight(const glm::dvec3& wo, double alpha, double ior, double u, double v) {
    const glm::dvec3 h = visibleNormal(wo, alpha, u, v);
    const glm::dvec3 wi = 2 * glm::dot(wo, h) * h - wo;
    if (wi.z <= 0) return 0;
    const double so = stretch(wo, alpha), si = stretch(wi, alpha);
    const double shadowing = wi.z * (wo.z + so) / (wo.z * si + wi.z * so);
    return fresnelDielectric(glm::dot(wo, h), ior) * shadowing;
}

// 2 ∫ E cosθ dcosθ with cosθ = x², over the linear interpolant that the shader sees.
double averageOf(const std::vector<double>& row) {
    constexpr int kSteps = 1024;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = (i + 0.5) / kSteps, at = x * (kSize - 1);
        const int cell = std::min(static_cast<int>(at), kSize - 2);
        const double f = at - cell;
        sum += (row[static_cast<size_t>(cell)] * (1 - f) + row[static_cast<size_t>(cell) + 1] * f) * 4 * x *
               x * x;
    }
    return sum / kSteps;
}

}  // namespace

double reflectionAlbedo(double cosTheta, double alpha, double ior) {
    if (ior == 1) return 0;
    const double z = std::clamp(cosTheta, 1e-6, 1.0);
    const glm::dvec3 wo(std::sqrt(1 - z * z), 0, z);
    if (alpha == 0) return fresnelDielectric(z, ior);
    double sum = 0;
    for (int i = 0; i < kStrata; ++i)
        for (int j = 0; j < kStrata; ++j)
            sum += sampleWeight(wo, alpha, ior, (i + 0.5) / kStrata, (j + 0.5) / kStrata);
    return sum / (kStrata * kStrata);
}

std::vector<glm::vec4> tabulateAlbedo(const std::function<double(double, double)>& albedo) {
    std::vector<std::vector<double>> rows(kSize, std::vector<double>(kSize));
    std::vector<double> averages(kSize);
    for (size_t y = 0; y < kSize; ++y) {
        const double roughness = static_cast<double>(y) / (kSize - 1);
        for (size_t x = 0; x < kSize; ++x) {
            const double root = static_cast<double>(x) / (kSize - 1);
            rows[y][x] = albedo(root * root, roughness);
        }
        averages[y] = averageOf(rows[y]);
    }
    std::vector<glm::vec4> texels;
    texels.reserve(kSize * (kSize + 1));
    for (size_t y = 0; y < kSize; ++y)
        for (size_t x = 0; x < kSize; ++x) {
            const size_t x1 = std::min<size_t>(x + 1, kSize - 1), y1 = std::min<size_t>(y + 1, kSize - 1);
            texels.emplace_back(rows[y][x], rows[y][x1], rows[y1][x], rows[y1][x1]);
        }
    for (size_t x = 0; x < kSize; ++x)
        texels.emplace_back(averages[x], averages[std::min<size_t>(x + 1, kSize - 1)], 0, 0);
    return texels;
}

std::vector<glm::vec4> buildAlbedoTable(double ior) {
    return tabulateAlbedo([&](double cosTheta, double roughness) {
        return reflectionAlbedo(cosTheta, roughness * roughness, ior);
    });
}

}  // namespace tilefarm
