#include "worker/render/layer_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

constexpr double kPi = std::numbers::pi;

// ∫ f cosθi dωi over the upper hemisphere with cosθi = t³, by plain quadrature of n × n points.
template <typename Eval>
double hemisphere(double cosTheta, int n, Eval evaluate) {
    const glm::dvec3 wo(std::sqrt(1 - cosTheta * cosTheta), 0, cosTheta);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double t = (i + 0.5) / n, z = t * t * t, r = std::sqrt(1 - z * z),
                         phi = kPi * (j + 0.5) / n;
            sum += evaluate(wo, glm::dvec3(r * std::cos(phi), r * std::sin(phi), z)) * 3 * t * t;
        }
    return sum * 2 * kPi / (double(n) * n);
}

// Estevez and Kulla's formulas as printed, table 1 and eq. 2 and 3.
double lambda(double cosTheta, double alpha) {
    const double k = (1 - alpha) * (1 - alpha);
    const auto p = [&](double at0, double at1) { return k * at0 + (1 - k) * at1; };
    const auto l = [&](double x) {
        return p(25.3245, 21.5473) / (1 + p(3.32435, 3.82987) * std::pow(x, p(0.16801, 0.19823))) +
               p(-1.27393, -1.97760) * x + p(-4.85967, -4.32054);
    };
    return cosTheta < 0.5 ? std::exp(l(cosTheta)) : std::exp(2 * l(0.5) - l(1 - cosTheta));
}

TEST(LayerTables, SheenEqualsQuadratureOfCharlie) {
    for (const double roughness : {0.1, 0.3, 0.6, 1.0})
        for (const double cosTheta : {0.02, 0.2, 0.6, 0.95}) {
            const double alpha = roughness * roughness;
            const double expected =
                hemisphere(cosTheta, 600, [&](const glm::dvec3& wo, const glm::dvec3& wi) {
                    const double sine = std::sqrt(1 - std::pow(glm::normalize(wo + wi).z, 2));
                    const double d = (2 + 1 / alpha) * std::pow(sine, 1 / alpha) / (2 * kPi);
                    return d / (4 * wo.z * (1 + lambda(wo.z, alpha) + lambda(wi.z, alpha)));
                });
            EXPECT_NEAR(sheenAlbedo(cosTheta, roughness), expected, 5e-3 * expected + 1e-5)
                << "roughness " << roughness << " cos " << cosTheta;
        }
}

TEST(LayerTables, Gtr1EqualsQuadratureOfBurleysFormula) {
    for (const double alpha : {0.1, 0.3, 0.7})
        for (const double cosTheta : {0.1, 0.4, 0.95}) {
            const double expected =
                hemisphere(cosTheta, 1500, [&](const glm::dvec3& wo, const glm::dvec3& wi) {
                    const glm::dvec3 h = glm::normalize(wo + wi);
                    const double a2 = alpha * alpha, c = glm::dot(wo, h);
                    const double d = (a2 - 1) / (kPi * std::log(a2) * (1 + (a2 - 1) * h.z * h.z));
                    const auto g = [](double z) {
                        return 2 * z / (z + std::sqrt(0.0625 + z * z - 0.0625 * z * z));
                    };
                    const double t = std::sqrt(1 - (1 - c * c) / 2.25);
                    const double f = 0.5 * (std::pow((1.5 * c - t) / (1.5 * c + t), 2) +
                                            std::pow((c - 1.5 * t) / (c + 1.5 * t), 2));
                    return d * f * g(wo.z) * g(wi.z) / (4 * wo.z);
                });
            EXPECT_NEAR(gtr1Albedo(cosTheta, alpha), expected, 1e-3)
                << "alpha " << alpha << " cos " << cosTheta;
        }
}

TEST(LayerTables, AreFiniteAndTheCoatsNeverAboveOne) {
    for (const glm::vec4& texel : buildGtr1Table())
        for (int c = 0; c < 4; ++c) {
            ASSERT_GE(texel[c], 0);
            ASSERT_LE(texel[c], 1);
        }
    for (const glm::vec4& texel : buildSheenTable())
        for (int c = 0; c < 4; ++c) {
            ASSERT_TRUE(std::isfinite(texel[c]));
            ASSERT_GE(texel[c], 0);
        }
}

}  // namespace
}  // namespace tilefarm
