// Cases 20, 22, 23, 27 and 28, of layers, stretched facets, specular colour, and metals of measured
// index.
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/picture.h"
#include "tests/shader/lobe_checks.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
constexpr uint64_t kStretched = kFacets | gpu::bit(gpu::FEATURE_ANISOTROPY);
constexpr uint64_t kCompensated = kFacets | gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
constexpr uint64_t kTinted = kFacets | gpu::bit(gpu::FEATURE_SPECULAR_COLOR);
constexpr uint64_t kConductor = kFacets | gpu::bit(gpu::FEATURE_CONDUCTOR);
constexpr uint64_t kCoated = kFacets | gpu::bit(gpu::FEATURE_CLEARCOAT);

class HardInterface : public LobeTest {};

// ---- 20

TEST_F(HardInterface, HardCase20_CompensatedFacetsReturnAllLight) {
    const auto expectAll = [&](const char* name, const ProbeMaterial& material) {
        for (const double cosTheta : {0.05, 0.3, 0.7, 1.0}) {
            const Moments m = albedo({name, material, kCompensated}, cosTheta, 65536);
            recordWorst(name, std::abs(m.energy.x - 1));
            recordWorst("sigma", m.energySigma);
            EXPECT_NEAR(m.energy.x, 1, zLimit() * m.energySigma + 0.005)
                << name << " alpha " << material.alpha << " cos " << cosTheta;
        }
    };
    for (const float alpha : {0.02f, 0.1f, 0.5f, 1.0f}) {
        expectAll("metal", {.metallic = 1, .alpha = alpha});
        expectAll("glass", {.alpha = alpha, .transmission = 1});
        expectAll("inside", {.alpha = alpha, .transmission = 1, .frontFace = 0});
    }
}

// ---- 22

TEST_F(HardInterface, HardCase22_RoughnessOf1e4IsAMirrorBothWays) {
    // α = 1e-8, a delta lobe: there and back with the same reflectance.
    const float alpha = 1e-8f;
    for (const LobeRow& row :
         {LobeRow{"metal", {.baseColor = {.9f, .6f, .3f}, .metallic = 1, .alpha = alpha}, kFacets},
          LobeRow{"coat",
                  {.baseColor = glm::vec3(0),
                  .alpha = alpha,
                  .ior = 1,
                  .flags = float(gpu::MATERIAL_THIN),
                  .clearcoat = 1,
                  .clearcoatAlpha = alpha},
                  kCoated}})
        for (const double cosTheta : {1e-3, 0.1, 0.5, 0.9, 1.0}) {
            const auto draw = [&](const glm::vec3& wo) {
                return probe(row.features).ask({drawQuery(row.material, wo, {0.001f, 0.3f, 0.6f})}).front();
            };
            const BsdfAnswer there = draw(directionAt(cosTheta)), back = draw(glm::vec3(there.wi));
            ASSERT_EQ(there.value.w, 2) << row.name << " cos " << cosTheta;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(there.value[c], back.value[c], 1e-4f * there.value[c]);
            EXPECT_NEAR(glm::length(glm::vec3(back.wi) - directionAt(cosTheta)), 0, 1e-6);
        }
}

// ---- 23

TEST_F(HardInterface, HardCase23_PicturesTowardsTheMirror) {
    const auto ball = [&](float alpha) {
        Scene scene;
        Material metal;
        metal.roughness = std::sqrt(alpha);
        addMesh(scene, sphereMesh(48), metal);
        scene.environment = uniformEnvironment(glm::vec3(0), 16, 8);
        for (uint32_t y = 0; y < 8; ++y)
            for (uint32_t x = 0; x < 16; ++x)
                for (uint32_t c = 0; c < 3; ++c)
                    scene.environment.image.rgbaFloat[4 * (y * 16 + x) + c] = static_cast<float>(
                        0.5 + 0.3 * std::cos(2 * pi * x / 16 + c) * std::sin(pi * (y + 0.5) / 8));
        return render(device, scene, cameraAt({0, 0, 4}, {0, 0, 0}, 0.5),
                      {.size = 32, .samples = 64, .maxBounces = 2});
    };
    const Picture mirror = ball(0);
    for (const float alpha : {1e-6f, 1.1e-3f}) {  // the second: the smoothest that is no mirror
        const double off = relMse(ball(alpha), mirror);
        recordWorst("towards", off);
        EXPECT_LE(off, 1e-3) << alpha;
    }
    EXPECT_GT(relMse(ball(0.5f), mirror), 1e-3) << "the picture tells them apart";
}

// ---- 27

TEST_F(HardInterface, HardCase27_SpecularOfNothing) {
    std::mt19937 random(27);
    std::uniform_real_distribution<float> u(0, 1);
    for (const float metallic : {1.0f, 0.0f})
        for (const float alpha : {0.0f, 1e-3f, 0.2f, 1.0f}) {
            ProbeMaterial none{
                .baseColor = {.9f, .5f, .1f}, .metallic = metallic, .alpha = alpha, .specular = 0};
            ProbeMaterial hardlyAny = none;
            hardlyAny.specular = 1e-6f;
            std::vector<BsdfQuery> a, b;
            for (int i = 0; i < 500; ++i) {
                const glm::vec3 wo = directionAt(0.01 + 0.99 * u(random), 7 * u(random)),
                                wi = directionAt(0.01 + 0.99 * u(random), 7 * u(random));
                a.push_back(evalQuery(none, wo, wi));
                b.push_back(evalQuery(hardlyAny, wo, wi));
            }
            const auto f = probe(kTinted).ask(a), g = probe(kTinted).ask(b);
            for (size_t i = 0; i < f.size(); ++i)
                for (int c = 0; c < 3; ++c) {
                    ASSERT_TRUE(std::isfinite(f[i].value[c]) && std::isfinite(g[i].value[c]));
                    // 1e-6 of a highlight, whose peak is 1 / (4 π α²), may show where there was none.
                    const double highlight = alpha > 0 ? 1e-6 / (4 * pi * alpha * alpha) : 0;
                    ASSERT_NEAR(f[i].value[c], g[i].value[c], 0.01 * f[i].value[c] + highlight)
                        << metallic << " alpha " << alpha;
                }
            for (const double cosTheta : {0.05, 0.5, 1.0}) {
                const glm::dvec3 x = albedo({"0", none, kTinted}, cosTheta, 4096).mean,
                                 y = albedo({"1e-6", hardlyAny, kTinted}, cosTheta, 4096).mean;
                for (int c = 0; c < 3; ++c) {
                    recordWorst("albedo", std::abs(x[c] - y[c]) / x[c]);
                    EXPECT_NEAR(x[c], y[c], 0.01 * x[c]) << metallic << " alpha " << alpha;
                }
            }
        }
}

TEST_F(HardInterface, HardCase27_BlackWithoutSpecularIsBlack) {
    Scene scene;
    Material black = matte(glm::vec3(0));
    black.ior = 1.5f;
    black.specular = 0;
    for (const float roughness : {0.0f, 0.03f, 0.5f, 1.0f}) {
        black.roughness = roughness;
        Scene ball;
        addMesh(ball, sphereMesh(24), black);
        ball.environment = uniformEnvironment(glm::vec3(1));
        const Picture picture =
            render(device, ball, cameraAt({0, 0, 4}, {0, 0, 0}, 0.3), {.size = 16, .samples = 16});
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        EXPECT_TRUE(allFinite(picture));
        int seen = 0;
        for (const FilmPixel& pixel : picture.pixels) {
            if (!hit(pixel)) continue;
            ++seen;
            for (size_t c = 0; c < 3; ++c) ASSERT_EQ(pixel.mean[c], 0) << "roughness " << roughness;
        }
        EXPECT_GT(seen, 100);
    }
}

// ---- 28

/// Fresnel's equations with complex numbers, unpolarised.
double exactConductor(double cosTheta, double eta, double k) {
    const std::complex<double> n(eta, k);
    const double sin2 = (1 - cosTheta) * (1 + cosTheta);
    const std::complex<double> beyond = std::sqrt(n * n - sin2);  // n cosθ beyond the interface
    const auto s = (cosTheta - beyond) / (cosTheta + beyond),
               p = (n * n * cosTheta - beyond) / (n * n * cosTheta + beyond);
    return 0.5 * (std::norm(s) + std::norm(p));
}

TEST_F(HardInterface, HardCase28_ConductorsAtTheirLimits) {
    const glm::vec3 u(0.5f, 0.3f, 0.6f);
    std::vector<BsdfQuery> queries;
    std::vector<glm::dvec3> asked;  // cosθ, η, k
    for (const float eta : {0.0f, 1e-6f, 1e-3f, 0.1f, 0.5f, 0.999f, 1.0f, 1.5f, 4.0f, 1e3f})
        for (const float k : {0.0f, 1e-6f, 1e-3f, 0.1f, 1.0f, 5.0f, 1e3f})
            for (const float cosTheta : {0.0f, 1e-7f, 1e-3f, 0.1f, 0.4f, 0.7f, 0.9f, 0.999f, 1.0f}) {
                const ProbeMaterial metal{.metallic = 1,
                                          .alpha = 0,
                                          .flags = float(gpu::MATERIAL_CONDUCTOR),
                                          .conductorEta = glm::vec3(eta),
                                          .conductorK = glm::vec3(k)};
                queries.push_back(drawQuery(metal, directionAt(double{cosTheta}), u));
                asked.emplace_back(double{queries.back().wo.z}, double{eta}, double{k});
            }
    const auto answers = probe(kConductor).ask(queries);
    size_t total = 0;
    for (size_t i = 0; i < answers.size(); ++i) {
        const double value = double{answers[i].value.x}, cosTheta = asked[i].x, eta = asked[i].y,
                     k = asked[i].z;
        SCOPED_TRACE(testing::Message() << "eta " << eta << " k " << k << " cos " << cosTheta);
        ASSERT_TRUE(std::isfinite(value));
        ASSERT_GE(value, 0);
        ASSERT_LE(value, 1 + 1e-6);
        // An index of 0 is the limit of small ones; the mirror along the surface goes nowhere.
        if (cosTheta < 1e-6 || (eta == 0 && k == 0)) continue;
        const double exact = exactConductor(cosTheta, eta, k);
        total += exact > 1 - 1e-9;
        recordWorst("reflectance", std::abs(value - exact));
        ASSERT_NEAR(value, exact, 1e-5);
    }
    EXPECT_GT(total, 20u) << "k = 0 and n < 1 reflect everything from their critical angle on";
}

TEST_F(HardInterface, HardCase28_RoughConductorsOfReflectance1) {
    // A metal without absorption and of next to no index reflects everything: what its facets then return is
    // what those of unit reflectance do, and never more than came.
    for (const float alpha : {0.02f, 0.3f, 1.0f})
        for (const float eta : {0.0f, 1e-3f, 0.2f, 0.7f}) {
            const LobeRow row{"conductor",
                              {.metallic = 1,
                               .alpha = alpha,
                               .flags = float(gpu::MATERIAL_CONDUCTOR),
                               .conductorEta = glm::vec3(eta)},
                              kConductor};
            expectFinite(row);
            expectEnergy(row, 1 + 1e-6);
        }
}

}  // namespace
}  // namespace tilefarm
