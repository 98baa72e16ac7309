// The base of every material: Lambert under a dielectric, metals by Schlick, glass.
#include <cmath>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_checks.h"
#include "worker/render/albedo_table.h"

namespace tilefarm {
namespace {

constexpr float kIor = 1.5f;
constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);

LobeRow row(std::string name, const ProbeMaterial& material) {
    return {std::move(name), material, kFacets};
}

std::vector<LobeRow> rows() {
    return {
        row("plastic", {.baseColor = {.8f, .5f, .2f}}),
        row("metal 0.05", {.metallic = 1, .alpha = 0.05f}),
        row("metal 0.3", {.baseColor = {.9f, .6f, .3f}, .metallic = 1, .alpha = 0.3f}),
        row("half metal", {.metallic = 0.5f, .alpha = 0.6f}),
        row("glass 0.1", {.alpha = 0.1f, .transmission = 1}),
        row("glass 0.1 inside", {.alpha = 0.1f, .transmission = 1, .frontFace = 0}),
        row("glass 0.4 inside", {.alpha = 0.4f, .transmission = 1, .frontFace = 0}),
        row("thin glass", {.alpha = 0.2f, .transmission = 1, .flags = kThin}),
        row("half thin glass", {.alpha = 0.3f, .transmission = 0.4f, .flags = kThin}),
    };
}

class BsdfBaseTest : public LobeTest {};

TEST_F(BsdfBaseTest, EveryRowIsSound) {
    for (const LobeRow& r : rows()) expectSoundLobe(r);
}

TEST_F(BsdfBaseTest, DirectionsFollowThePdf) {
    for (const LobeRow& r : rows())
        for (const double cosTheta : {0.1, 0.6, 0.95}) expectChiSquare(r, cosTheta);
    for (const float alpha : {1e-3f, 0.01f})
        for (const double degrees : {0, 30, 60, 80, 85, 89}) {
            const double cosTheta = std::cos(degrees * 0.017453292519943295);
            expectChiSquare(row("smooth metal", {.metallic = 1, .alpha = alpha}), cosTheta);
            expectChiSquare(row("smooth glass", {.alpha = alpha, .transmission = 1}), cosTheta);
        }
    expectChiSquare({"matte", {.alpha = 1, .ior = 1}, 0}, 0.6);
}

TEST_F(BsdfBaseTest, WhiteLambertReturnsAllLight) {
    const LobeRow matte{"matte", {.alpha = 1, .ior = 1}, 0};
    for (const uint64_t features : {uint64_t{0}, kFacets}) {
        const Moments m = albedo({"matte", matte.material, features}, 0.6, 4096);
        EXPECT_NEAR(m.mean.x, 1, 1e-3);
    }
}

TEST_F(BsdfBaseTest, WhitePlasticReturnsAllLightAtEveryAngleAndRoughness) {
    for (const double cosTheta : {0.05, 0.3, 0.7, 1.0})
        for (const float alpha : {0.0f, 0.01f, 0.1f, 0.4f, 1.0f}) {
            const Moments m = albedo(row("plastic", {.alpha = alpha}), cosTheta);
            EXPECT_NEAR(m.mean.x, 1, 4 * m.sigma + 0.005) << "cos " << cosTheta << " alpha " << alpha;
        }
}

TEST_F(BsdfBaseTest, WhiteMetalReturnsItsSingleScatteringAlbedo) {
    for (const double cosTheta : {0.1, 0.5, 0.9})
        for (const float alpha : {0.02f, 0.3f, 1.0f}) {
            const Moments m = albedo(row("metal", {.metallic = 1, .alpha = alpha}), cosTheta);
            // An index so large that everything is reflected gives E for F = 1.
            const double expected = reflectionAlbedo(cosTheta, alpha, 1e9);
            EXPECT_NEAR(m.mean.x, expected, 4 * m.sigma + 0.005) << "cos " << cosTheta << " alpha " << alpha;
        }
}

TEST_F(BsdfBaseTest, ClearGlassKeepsAllEnergyButWhatMaskingTakes) {
    for (const float frontFace : {1.f, 0.f})
        for (const float alpha : {0.f, 0.05f})
            for (const double cosTheta : {0.2, 0.6, 0.95}) {
                const Moments m = albedo(
                    row("glass", {.alpha = alpha, .transmission = 1, .frontFace = frontFace}), cosTheta);
                // Single scattering: what microfacets shadow is lost, hardly more than a perfect mirror
                // loses. The 5e-3 are for refracted directions that turn back above the surface (2e-3 to 3e-3
                // measured).
                const double least = reflectionAlbedo(cosTheta, alpha, 1e9), slack = 4 * m.energySigma + 5e-3;
                EXPECT_GE(m.energy.x, least - slack)
                    << frontFace << " alpha " << alpha << " cos " << cosTheta;
                EXPECT_LE(m.energy.x, 1 + slack) << frontFace << " alpha " << alpha << " cos " << cosTheta;
            }
}

TEST_F(BsdfBaseTest, ThinGlassSplitsLightByFresnel) {
    const Moments m = albedo(row("pane", {.alpha = 0, .transmission = 1, .flags = kThin}), 1);
    EXPECT_NEAR(m.transmitted.x, 0.96, 4 * std::sqrt(0.96 * 0.04 / 16384));
    EXPECT_NEAR(m.mean.x, 1, 4 * m.sigma + 1e-3);
}

TEST_F(BsdfBaseTest, EveryRoughnessStaysFinite) {
    for (const float alpha : {0.f, 1e-3f, 0.1f, 1.f})
        for (const float transmission : {0.f, 1.f})
            for (const float frontFace : {0.f, 1.f})
                expectFinite(
                    row("glass", {.alpha = alpha, .transmission = transmission, .frontFace = frontFace}));
}

}  // namespace
}  // namespace tilefarm
