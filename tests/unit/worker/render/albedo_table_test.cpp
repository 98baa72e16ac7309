#include "worker/render/albedo_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

double fresnel(double c, double eta) {
    const double t = std::sqrt(1 - (1 - c * c) / (eta * eta));
    return 0.5 * (std::pow((eta * c - t) / (eta * c + t), 2) + std::pow((c - eta * t) / (c + eta * t), 2));
}

// The albedo by plain quadrature of D F G2 / (4 cosθo) over the hemisphere: no sampling in it.
double bruteForce(double cosTheta, double a, double eta) {
    const glm::dvec3 wo(std::sqrt(1 - cosTheta * cosTheta), 0, cosTheta);
    const auto stretch = [&](const glm::dvec3& w) {
        return std::sqrt(w.z * w.z + a * a * (w.x * w.x + w.y * w.y));
    };
    constexpr int n = 700;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double z = (i + 0.5) / n, phi = 2 * std::numbers::pi * (j + 0.5) / n,
                         r = std::sqrt(1 - z * z);
            const glm::dvec3 wi(r * std::cos(phi), r * std::sin(phi), z);
            const glm::dvec3 h = glm::normalize(wo + wi);
            const double s = a * a * h.z * h.z + h.x * h.x + h.y * h.y;
            const double d = a * a / (std::numbers::pi * s * s);
            sum += d * 0.5 / (wo.z * stretch(wi) + wi.z * stretch(wo)) * fresnel(glm::dot(wo, h), eta) * wi.z;
        }
    return sum * 2 * std::numbers::pi / (double(n) * n);
}

TEST(AlbedoTable, EqualsQuadratureOverTheHemisphere) {
    for (const double cosTheta : {0.15, 0.5, 0.95})
        for (const double alpha : {0.2, 0.5, 1.0})
            EXPECT_NEAR(reflectionAlbedo(cosTheta, alpha, 1.5), bruteForce(cosTheta, alpha, 1.5), 1e-3)
                << "cos " << cosTheta << " alpha " << alpha;
}

TEST(AlbedoTable, IsFresnelWhereTheSurfaceIsSmooth) {
    EXPECT_NEAR(reflectionAlbedo(1, 0, 1.5), 0.04, 1e-12);
    EXPECT_NEAR(reflectionAlbedo(0.3, 0, 1.5), fresnel(0.3, 1.5), 1e-12);
    EXPECT_EQ(reflectionAlbedo(0.3, 0.5, 1), 0);
}

TEST(AlbedoTable, NeverExceedsOneEvenAtGrazing) {
    for (const double ior : {1.01, 1.5, 2.4, 10.0})
        for (const glm::vec4& texel : buildAlbedoTable(ior))
            for (int c = 0; c < 4; ++c) {
                ASSERT_GE(texel[c], 0);
                ASSERT_LE(texel[c], 1);
            }
}

TEST(AlbedoTable, TexelsHoldTheirNeighbours) {
    const auto table = buildAlbedoTable(1.5);
    constexpr size_t n = gpu::ALBEDO_TABLE_SIZE;
    ASSERT_EQ(table.size(), n * (n + 1));
    EXPECT_EQ(table[5].y, table[6].x);
    EXPECT_EQ(table[5].z, table[5 + n].x);
    EXPECT_EQ(table[5].w, table[6 + n].x);
}

}  // namespace
}  // namespace tilefarm
