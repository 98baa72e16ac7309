// Light that scatters more than once between microfacets: what is lossless returns everything.
#include <cmath>
#include <cstring>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_checks.h"

namespace tilefarm {
namespace {

constexpr uint64_t kCompensated = gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) |
                                  gpu::bit(gpu::FEATURE_TRANSMISSION) |
                                  gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
constexpr uint64_t kAll = kCompensated | gpu::bit(gpu::FEATURE_SPECULAR_COLOR) |
                          gpu::bit(gpu::FEATURE_BECKMANN) | gpu::bit(gpu::FEATURE_PHONG) |
                          gpu::bit(gpu::FEATURE_SCHLICK) | gpu::bit(gpu::FEATURE_CONDUCTOR);
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);
constexpr auto kBeckmann = static_cast<float>(gpu::MATERIAL_BECKMANN);
constexpr auto kPhong = static_cast<float>(gpu::MATERIAL_PHONG);
constexpr auto kSchlick = static_cast<float>(gpu::MATERIAL_SCHLICK);

class BsdfCompensationTest : public LobeTest {
protected:
    void expectLossless(const std::string& name, const ProbeMaterial& material, double slack = 0.005) {
        for (const double cosTheta : {0.05, 0.3, 0.7, 1.0}) {
            const Moments m = albedo({name, material, kAll}, cosTheta, 4096);
            EXPECT_NEAR(m.energy.r, 1, 4 * m.energySigma + slack)
                << name << " alpha " << material.alpha << " cos " << cosTheta;
        }
    }
};

constexpr float kRoughness[]{0.02f, 0.1f, 0.5f, 1.f};

TEST_F(BsdfCompensationTest, WhiteMetalReturnsAllLight) {
    for (const float alpha : kRoughness)
        for (const float flags : {0.f, kBeckmann, kPhong})
            expectLossless("metal", {.metallic = 1, .alpha = alpha, .flags = flags});
}

TEST_F(BsdfCompensationTest, WhitePlasticReturnsAllLight) {
    for (const float alpha : kRoughness) {
        expectLossless("plastic", {.alpha = alpha});
        expectLossless("half metal", {.metallic = 0.5f, .alpha = alpha});
        expectLossless("Schlick plastic", {.alpha = alpha, .ior = 2, .flags = kSchlick});
        expectLossless("tinted plastic",
                       {.alpha = alpha, .specular = 0.5f, .specularColor = glm::vec3(0.5f)});
    }
}

TEST_F(BsdfCompensationTest, RoughGlassReflectsAndTransmitsAllLight) {
    for (const float alpha : kRoughness) {
        for (const float side : {1.f, 0.f}) {
            expectLossless("glass", {.alpha = alpha, .transmission = 1, .frontFace = side});
            expectLossless("diamond", {.alpha = alpha, .ior = 2.4f, .transmission = 1, .frontFace = side});
            expectLossless("Beckmann glass",
                           {.alpha = alpha, .transmission = 1, .flags = kBeckmann, .frontFace = side});
        }
        expectLossless("pane", {.alpha = alpha, .transmission = 1, .flags = kThin});
        expectLossless("half glass", {.alpha = alpha, .transmission = 0.5f});
    }
}

std::vector<LobeRow> rows() {
    return {
        {"metal", {.baseColor = {.9f, .6f, .3f}, .metallic = 1, .alpha = 0.8f}, kCompensated},
        {"plastic", {.baseColor = {.9f, .6f, .3f}, .alpha = 0.8f}, kCompensated},
        {"glass", {.baseColor = {.9f, .6f, .3f}, .alpha = 0.5f, .transmission = 1}, kCompensated},
        {"glass inside",
         {.baseColor = {.9f, .6f, .3f}, .alpha = 0.5f, .transmission = 1, .frontFace = 0},
         kCompensated},
        {"pane",
         {.baseColor = {.9f, .6f, .3f}, .alpha = 0.7f, .transmission = 1, .flags = kThin},
         kCompensated},
        {"half glass", {.alpha = 0.6f, .transmission = 0.5f, .specular = 0.5f}, kAll},
    };
}

TEST_F(BsdfCompensationTest, EveryRowIsSound) {
    for (const LobeRow& r : rows()) {
        // Partly transmissive solids show another base from inside.
        expectSoundLobe(r, r.name != "half glass");
        for (const double cosTheta : {0.2, 0.8}) expectChiSquare(r, cosTheta);
    }
}

TEST_F(BsdfCompensationTest, RestoresTheLightThatAbsorbingMetalsWouldScatterAgainTintedDeeper) {
    const ProbeMaterial copper{.baseColor = {.9f, .5f, .3f}, .metallic = 1, .alpha = 1};
    const glm::dvec3
        without =
            albedo({"plain", copper, kCompensated & ~gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION)}, 0.8).mean,
        with = albedo({"compensated", copper, kCompensated}, 0.8).mean;
    EXPECT_GT(with.r, without.r * 1.1);
    EXPECT_GT(with.r / without.r, with.b / without.b * 1.05) << "each bounce takes the colour once more";
}

TEST_F(BsdfCompensationTest, NoMixtureOfParametersCreatesEnergyOrWhatIsNotFinite) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(0, 1);
    const float iors[]{1, 1.33f, 1.5f, 2.4f};
    // As much noise as 16 samples of each of 10,000 vectors: grouped by what the tables depend on.
    for (int group = 0; group < 40; ++group) {
        std::vector<BsdfQuery> queries;
        ProbeMaterial m;
        const auto somewhere = [&](float extreme) {
            const float u = uniform(random);
            return u < 0.2f ? 0.f : u > 1 - extreme ? 1.f : uniform(random);
        };
        for (int i = 0; i < 250; ++i) {
            m.baseColor = glm::vec3(1);
            m.metallic = somewhere(0.1f);
            m.alpha = 1e-3f + somewhere(0.1f) * 0.999f;
            m.ior = iors[group % 4];
            m.transmission = somewhere(0.3f);
            m.flags = (group % 3 == 0 ? kThin : 0) +
                      (group % 5 == 1   ? kBeckmann
                       : group % 5 == 2 ? kPhong
                                        : 0) +
                      (group % 7 == 3 ? kSchlick : 0);
            m.frontFace = group % 2 == 0 ? 1.f : 0.f;
            m.specular = somewhere(0.5f);
            m.specularColor = glm::vec3(somewhere(0.3f), somewhere(0.3f), somewhere(0.3f));
            const glm::vec3 wo = directionAt(0.02 + 0.98 * uniform(random));
            for (int k = 0; k < 16; ++k)
                queries.push_back(drawQuery(m, wo, {uniform(random), uniform(random), uniform(random)}));
        }
        const auto answers = probe(kAll).ask(queries);
        double sum = 0, squares = 0;
        for (size_t i = 0; i < answers.size(); i += 16) {
            ProbeMaterial asked;
            std::memcpy(static_cast<void*>(&asked), queries[i].material, sizeof asked);
            const bool solid =
                (static_cast<uint32_t>(asked.flags) & gpu::MATERIAL_THIN) == 0 && asked.transmission > 0;
            const double eta = !solid ? 1 : asked.frontFace != 0 ? asked.ior : 1 / double{asked.ior};
            double mean = 0;
            for (size_t k = i; k < i + 16; ++k) {
                for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(answers[k].value[c]));
                mean += answers[k].value.y * (answers[k].wi.z < 0 ? eta * eta : 1) / 16;
            }
            sum += mean;
            squares += mean * mean;
        }
        const double n = double(answers.size()) / 16, mean = sum / n;
        EXPECT_LE(mean, 1.005 + 4 * std::sqrt(std::max(squares / n - mean * mean, 0.0) / n))
            << "group " << group;
    }
}

}  // namespace
}  // namespace tilefarm
