#include "worker/render/layer_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shaders/gpu_types.h"
#include "worker/render/albedo_table.h"

namespace tilefarm {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastCosine = 1e-6;  // as sheenEval has it
constexpr double kLeastSheenRoughness = 0.0316228;
constexpr double kCoatIor = 1.5;
constexpr int kHeights = 64, kAzimuths = 48;  // of the quadratures

double mix(double a, double b, double t) {
    return a + (b - a) * t;
}

double charlieL(double x, double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const double a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
    return a / (1 + b * std::pow(x, c)) + mix(-1.97760, -1.27393, t) * x + mix(-4.32054, -4.85967, t);
}

double charlieLambda(double cosTheta, double alpha) {
    return cosTheta < 0.5 ? std::exp(charlieL(cosTheta, alpha))
                          : std::exp(2 * charlieL(0.5, alpha) - charlieL(1 - cosTheta, alpha));
}

// Reflectance at h towards wi, over the density with which shaders/bsdf/gtr1.glsl samples wi.
double gtr1Weight(const glm::dvec3& wo, double alpha, double u, double v) {
    const double a2 = alpha * alpha;
    const double sinSquared = a2 < 1 ? (std::pow(a2, 1 - u) - a2) / (1 - a2) : u;
    const double r = std::sqrt(sinSquared),
                 phi = kPi * v;  // wo is in the plane φ = 0; the other half is alike
    const glm::dvec3 h(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - sinSquared));
    const double cosine = glm::dot(wo, h);
    const double zi = 2 * cosine * h.z - wo.z;
    if (cosine <= 0 || zi <= 0) return 0;
    const auto masking = [](double z) { return 2 * z / (z + std::sqrt(z * z + 0.0625 * (1 - z * z))); };
    const double cosT = std::sqrt(1 - (1 - cosine * cosine) / (kCoatIor * kCoatIor));
    const double p = (kCoatIor * cosine - cosT) / (kCoatIor * cosine + cosT),
                 s = (cosine - kCoatIor * cosT) / (cosine + kCoatIor * cosT);
    return 0.5 * (p * p + s * s) * masking(wo.z) * masking(zi) * cosine / (wo.z * h.z);
}

}  // namespace

double sheenAlbedo(double cosTheta, double roughness) {
    const double alpha = std::pow(std::clamp(roughness, kLeastSheenRoughness, 1.0), 2);
    const double zo = std::clamp(cosTheta, kLeastCosine, 1.0), so = std::sqrt(1 - zo * zo);
    const double lambdaOut = charlieLambda(zo, alpha);
    double sum = 0;
    for (int i = 0; i < kHeights; ++i) {
        const double t = (i + 0.5) / kHeights, z = t * t * t;  // dense at the rim, where the lobe is
        const double s = std::sqrt(1 - z * z);
        double ring = 0;
        for (int j = 0; j < kAzimuths; ++j) {
            const double x = s * std::cos(kPi * (j + 0.5) / kAzimuths);
            const double cosSquared = (z + zo) * (z + zo) / (2 + 2 * (x * so + z * zo));
            ring += std::exp(std::log1p(-std::min(cosSquared, 1 - 1e-15)) * 0.5 / alpha);
        }
        sum += 3 * t * t * ring / (1 + lambdaOut + charlieLambda(z, alpha));
    }
    return sum * (2 + 1 / alpha) / (4 * zo * kHeights * kAzimuths);
}

double gtr1Albedo(double cosTheta, double alpha) {
    const double z = std::clamp(cosTheta, kLeastCosine, 1.0);
    const glm::dvec3 wo(std::sqrt(1 - z * z), 0, z);
    double sum = 0;
    for (int i = 0; i < kHeights; ++i)
        for (int j = 0; j < kAzimuths; ++j)
            sum += gtr1Weight(wo, std::clamp(alpha, 1e-3, 1.0), (i + 0.5) / kHeights, (j + 0.5) / kAzimuths);
    return sum / (kHeights * kAzimuths);
}

std::vector<glm::vec4> buildSheenTable() {
    // Towards grazing angles Charlie bends at any roughness: lines between the points would be low by 1 %.
    return tabulateAlbedo(
        [](double cosTheta, double root) {
            const double roughness = kLeastSheenRoughness + (1 - kLeastSheenRoughness) * root * root;
            return sheenAlbedo(cosTheta, roughness) * roughness;
        },
        gpu::ALBEDO_TABLE_SIZE - 1);
}

std::vector<glm::vec4> buildGtr1Table() {
    return tabulateAlbedo(
        [](double cosTheta, double roughness) { return gtr1Albedo(cosTheta, roughness * roughness); });
}

}  // namespace tilefarm
