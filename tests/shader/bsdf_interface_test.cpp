// What varies the interface: KHR_materials_specular, Schlick's curve, measured metals, other distributions.
#include <cmath>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_checks.h"
#include "worker/scene/conductors.h"

namespace tilefarm {
namespace {

constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
constexpr uint64_t kTinted = kFacets | gpu::bit(gpu::FEATURE_SPECULAR_COLOR);
constexpr uint64_t kSchlick = kFacets | gpu::bit(gpu::FEATURE_SCHLICK);
constexpr uint64_t kConductor = kFacets | gpu::bit(gpu::FEATURE_CONDUCTOR);
constexpr uint64_t kDistributions = kFacets | gpu::bit(gpu::FEATURE_BECKMANN) | gpu::bit(gpu::FEATURE_PHONG);
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);
constexpr auto kBeckmannFlag = static_cast<float>(gpu::MATERIAL_BECKMANN);
constexpr auto kPhongFlag = static_cast<float>(gpu::MATERIAL_PHONG);
constexpr auto kSchlickFlag = static_cast<float>(gpu::MATERIAL_SCHLICK);
constexpr auto kConductorFlag = static_cast<float>(gpu::MATERIAL_CONDUCTOR);

ProbeMaterial metalOf(const char* name, float alpha) {
    const Conductor metal = conductorNamed(name).value();
    return {.metallic = 1,
            .alpha = alpha,
            .flags = kConductorFlag,
            .conductorEta = metal.eta,
            .conductorK = metal.k};
}

std::vector<LobeRow> rows() {
    return {
        {"specular half", {.specular = 0.5f}, kTinted},
        {"specular blue", {.alpha = 0.1f, .specularColor = {.1f, .3f, 1}}, kTinted},
        {"specular black", {.specularColor = glm::vec3(0)}, kTinted},
        {"specular glass", {.transmission = 1, .specular = 0.4f, .specularColor = {1, .5f, .2f}}, kTinted},
        {"specular glass inside",
         {.transmission = 1, .specular = 0.4f, .frontFace = 0, .specularColor = {1, .5f, .2f}},
         kTinted},
        {"ideal", {.baseColor = {.2f, .3f, .4f}, .ior = 0, .specularColor = {.9f, .7f, .3f}}, kTinted},
        {"Schlick plastic", {.flags = kSchlickFlag}, kSchlick},
        {"Schlick glass", {.transmission = 1, .flags = kSchlickFlag}, kSchlick},
        {"Schlick glass inside", {.transmission = 1, .flags = kSchlickFlag, .frontFace = 0}, kSchlick},
        {"gold", metalOf("gold", 0.2f), kConductor},
        {"aluminium", metalOf("aluminium", 0.02f), kConductor},
        {"Beckmann metal", {.metallic = 1, .alpha = 0.2f, .flags = kBeckmannFlag}, kDistributions},
        {"Beckmann plastic", {.alpha = 0.5f, .flags = kBeckmannFlag}, kDistributions},
        {"Beckmann glass", {.alpha = 0.2f, .transmission = 1, .flags = kBeckmannFlag}, kDistributions},
        {"Beckmann glass inside",
         {.alpha = 0.2f, .transmission = 1, .flags = kBeckmannFlag, .frontFace = 0},
         kDistributions},
        {"Phong metal", {.metallic = 1, .alpha = 0.2f, .flags = kPhongFlag}, kDistributions},
        {"Phong plastic", {.alpha = 0.5f, .flags = kPhongFlag}, kDistributions},
        {"Phong pane", {.alpha = 0.2f, .transmission = 1, .flags = kPhongFlag + kThin}, kDistributions},
    };
}

class BsdfInterfaceTest : public LobeTest {
protected:
    /// Reflectance of a smooth interface.
    glm::dvec3 mirrorColor(const ProbeMaterial& material, uint64_t features, double cosTheta) {
        ProbeMaterial smooth = material;
        smooth.alpha = 0;
        const Moments m = albedo({"mirror", smooth, features}, cosTheta, 65536);
        return m.mean - m.transmitted;
    }
};

TEST_F(BsdfInterfaceTest, EveryRowIsSound) {
    for (const LobeRow& r : rows()) expectSoundLobe(r);
}

TEST_F(BsdfInterfaceTest, DirectionsFollowThePdf) {
    for (const LobeRow& r : rows())
        for (const double cosTheta : {0.15, 0.8}) expectChiSquare(r, cosTheta);
    for (const float flag : {kBeckmannFlag, kPhongFlag})
        for (const float alpha : {1e-3f, 0.01f})
            expectChiSquare({"smooth metal", {.metallic = 1, .alpha = alpha, .flags = flag}, kDistributions},
                            0.5);
}

TEST_F(BsdfInterfaceTest, SpecularOfZeroLeavesTheBaseAlone) {
    const Moments m = albedo({"bare", {.baseColor = {.8f, .5f, .2f}, .specular = 0}, kTinted}, 0.5);
    EXPECT_NEAR(m.mean.r, 0.8, 1e-3);
    EXPECT_NEAR(m.mean.b, 0.2, 1e-3);
}

TEST_F(BsdfInterfaceTest, WhiteBaseUnderTintedSpecularKeepsAllLight) {
    for (const float specular : {0.3f, 1.f})
        for (const double cosTheta : {0.1, 0.5, 1.0}) {
            const Moments m = albedo(
                {"tinted", {.specular = specular, .specularColor = glm::vec3(0.4f)}, kTinted}, cosTheta);
            EXPECT_NEAR(m.mean.r, 1, 4 * m.sigma + 0.005) << specular << ' ' << cosTheta;
        }
}

TEST_F(BsdfInterfaceTest, SpecularColourScalesTheReflectanceAtNormalIncidence) {
    const glm::dvec3 color =
        mirrorColor({.baseColor = glm::vec3(0), .specular = 0.5f, .specularColor = {1, .5f, 0}}, kTinted, 1);
    EXPECT_NEAR(color.r, 0.02, 1e-4);
    EXPECT_NEAR(color.g, 0.01, 1e-4);
    EXPECT_NEAR(color.b, 0, 1e-4);
}

TEST_F(BsdfInterfaceTest, AnIndexOfZeroReflectsItsSpecularColour) {
    const glm::dvec3 color =
        mirrorColor({.baseColor = glm::vec3(0), .ior = 0, .specularColor = {.9f, .7f, .3f}}, kTinted, 1);
    EXPECT_NEAR(color.r, 0.9, 1e-4);
    EXPECT_NEAR(color.g, 0.7, 1e-4);
    EXPECT_NEAR(color.b, 0.3, 1e-4);
}

TEST_F(BsdfInterfaceTest, SchlickMeetsTheExactTermAtNormalIncidenceAndAtTheCriticalAngle) {
    const ProbeMaterial plastic{.baseColor = glm::vec3(0), .flags = kSchlickFlag};
    EXPECT_NEAR(mirrorColor(plastic, kSchlick, 1).r, 0.04, 1e-4);
    EXPECT_NEAR(mirrorColor(plastic, kSchlick, 0.5).r, 0.04 + 0.96 / 32, 1e-3);
    const ProbeMaterial inside{.transmission = 1, .flags = kSchlickFlag, .frontFace = 0};
    EXPECT_NEAR(mirrorColor(inside, kSchlick, 0.7).r, 1, 1e-4) << "beyond the critical angle";
}

double conductorReflectance(double c, double eta, double k) {
    const double s2 = 1 - c * c, t0 = eta * eta - k * k - s2,
                 a2b2 = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);
    const double a = std::sqrt(std::max(0.5 * (a2b2 + t0), 0.0));
    const double rs = (a2b2 + c * c - 2 * a * c) / (a2b2 + c * c + 2 * a * c);
    return 0.5 * rs *
           (1 + (c * c * a2b2 + s2 * s2 - 2 * a * c * s2) / (c * c * a2b2 + s2 * s2 + 2 * a * c * s2));
}

TEST_F(BsdfInterfaceTest, MetalsReflectAsTheExactTermOfTheirIndex) {
    for (const char* name : {"gold", "silver", "tungsten"})
        for (const double cosTheta : {0.05, 0.3, 0.8, 1.0}) {
            const Conductor metal = conductorNamed(name).value();
            const glm::dvec3 color = mirrorColor(metalOf(name, 0), kConductor, cosTheta);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(color[c], conductorReflectance(cosTheta, metal.eta[c], metal.k[c]), 1e-5) << name;
        }
}

// Hard case 28.
TEST_F(BsdfInterfaceTest, ConductorsWithoutAbsorptionOrWithASmallIndexStayFinite) {
    for (const float eta : {1e-3f, 0.2f, 0.9f, 1.f, 3.f})
        for (const float k : {0.f, 1e-6f, 5.f})
            for (const float alpha : {0.f, 0.1f}) {
                const LobeRow row{"conductor",
                                  {.metallic = 1,
                                   .alpha = alpha,
                                   .flags = kConductorFlag,
                                   .conductorEta = glm::vec3(eta),
                                   .conductorK = glm::vec3(k)},
                                  kConductor};
                expectFinite(row);
                EXPECT_LE(albedo(row, 0.3, 256).mean.r, 1 + 1e-6) << eta << ' ' << k;
            }
}

// Hard case 50, by way of the distributions: h = n and wo = n, the rounding of v·n above 1 included.
TEST_F(BsdfInterfaceTest, DistributionsAtTheirPeakAreExact) {
    for (const float flag : {0.f, kBeckmannFlag, kPhongFlag})
        for (const float alpha : {1.01e-3f, 0.1f, 1.f}) {
            const ProbeMaterial metal{.metallic = 1, .alpha = alpha, .flags = flag};
            for (const float z : {1.f, 1.00000012f}) {
                const auto answers = probe(kDistributions).ask({evalQuery(metal, {0, 0, z}, {0, 0, z})});
                const double expected = 1 / (std::acos(-1.0) * double{alpha} * alpha * 4);
                EXPECT_NEAR(answers[0].value.x, expected, 1e-4 * expected) << flag << ' ' << alpha;
            }
        }
}

TEST_F(BsdfInterfaceTest, BeckmannAndPhongAgreeWhereBothAreNarrow) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-0.05f, 0.05f);
    std::vector<BsdfQuery> beckmann, phong;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 wi = glm::normalize(glm::vec3(-0.6f + uniform(random), uniform(random), 0.8f));
        beckmann.push_back(
            evalQuery({.metallic = 1, .alpha = 0.05f, .flags = kBeckmannFlag}, {0.6f, 0, 0.8f}, wi));
        phong.push_back(evalQuery({.metallic = 1, .alpha = 0.05f, .flags = kPhongFlag}, {0.6f, 0, 0.8f}, wi));
    }
    const auto a = probe(kDistributions).ask(beckmann), b = probe(kDistributions).ask(phong);
    for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i].value.x, b[i].value.x, 0.02 * a[i].value.x + 1e-4);
}

}  // namespace
}  // namespace tilefarm
