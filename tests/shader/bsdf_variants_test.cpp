// Anisotropic roughness and thin films.
#include <cmath>
#include <complex>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_checks.h"

namespace tilefarm {
namespace {

constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
constexpr uint64_t kAnisotropic =
    kFacets | gpu::bit(gpu::FEATURE_ANISOTROPY) | gpu::bit(gpu::FEATURE_BECKMANN);
constexpr uint64_t kFilm = kFacets | gpu::bit(gpu::FEATURE_IRIDESCENCE);
constexpr uint64_t kCompensated = gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);
constexpr auto kBeckmann = static_cast<float>(gpu::MATERIAL_BECKMANN);

std::vector<LobeRow> anisotropicRows() {
    return {
        {"brushed metal", {.metallic = 1, .alpha = 0.1f, .alphaT = 0.5f}, kAnisotropic},
        {"finely brushed metal", {.metallic = 1, .alpha = 0.01f, .alphaT = 0.3f}, kAnisotropic},
        {"brushed plastic", {.baseColor = {.8f, .5f, .2f}, .alpha = 0.2f, .alphaT = 0.6f}, kAnisotropic},
        {"brushed glass", {.alpha = 0.1f, .alphaT = 0.4f, .transmission = 1}, kAnisotropic},
        {"brushed glass inside",
         {.alpha = 0.1f, .alphaT = 0.4f, .transmission = 1, .frontFace = 0},
         kAnisotropic},
        {"brushed pane", {.alpha = 0.1f, .alphaT = 0.4f, .transmission = 1, .flags = kThin}, kAnisotropic},
        {"Beckmann", {.metallic = 1, .alpha = 0.1f, .alphaT = 0.4f, .flags = kBeckmann}, kAnisotropic},
    };
}

std::vector<LobeRow> filmRows() {
    return {
        {"film on plastic", {.iridescence = 1, .iridescenceThickness = 400}, kFilm},
        {"film on metal",
         {.baseColor = {.9f, .6f, .3f}, .metallic = 1, .iridescence = 1, .iridescenceThickness = 300},
         kFilm},
        {"half a film",
         {.metallic = 0.5f, .iridescence = 0.5f, .iridescenceIor = 1.8f, .iridescenceThickness = 600},
         kFilm},
        {"film on glass", {.transmission = 1, .iridescence = 1, .iridescenceThickness = 350}, kFilm},
        {"film on glass inside",
         {.transmission = 1, .frontFace = 0, .iridescence = 1, .iridescenceThickness = 350},
         kFilm},
        {"soap bubble",
         {.alpha = 0.05f,
          .ior = 1.33f,
          .transmission = 1,
          .flags = kThin,
          .iridescence = 1,
          .iridescenceThickness = 250},
         kFilm},
    };
}

class BsdfVariantsTest : public LobeTest {};

TEST_F(BsdfVariantsTest, AnisotropicRowsAreSound) {
    for (const LobeRow& r : anisotropicRows()) expectSoundLobe(r);
}

TEST_F(BsdfVariantsTest, AnisotropicDirectionsFollowThePdf) {
    for (const LobeRow& r : anisotropicRows())
        for (const double cosTheta : {0.2, 0.8}) expectChiSquare(r, cosTheta);
}

TEST_F(BsdfVariantsTest, AnisotropyOfNoneIsIsotropicToTheBit) {
    std::vector<BsdfQuery> plain, alike;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 wo = directionAt(0.1 + 0.0017 * i), u{0.37f, float(i % 23) / 23, float(i % 31) / 31};
        plain.push_back(drawQuery({.metallic = 1, .alpha = 0.2f}, wo, u));
        alike.push_back(drawQuery({.metallic = 1, .alpha = 0.2f, .alphaT = 0.2f}, wo, u));
    }
    const auto a = probe(kFacets).ask(plain), b = probe(kAnisotropic).ask(alike);
    for (size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].wi, b[i].wi);
        EXPECT_EQ(a[i].value, b[i].value);
    }
}

// Compensation knows one α, so brushed metals go without: less light at high roughness, never more than came.
TEST_F(BsdfVariantsTest, BrushedMetalMakesNoLight) {
    for (const float alpha : {0.05f, 0.5f})
        for (const float strength : {0.3f, 1.f})
            for (const double cosTheta : {0.1, 0.9})
                for (const double phi : {0.0, 0.8, 1.57}) {
                    const float along = alpha + (1 - alpha) * strength * strength;
                    const ProbeMaterial metal{.metallic = 1, .alpha = alpha, .alphaT = along};
                    const Moments with =
                        albedo({"brushed", metal, kAnisotropic | kCompensated}, cosTheta, 2048, phi);
                    const Moments without = albedo({"brushed", metal, kAnisotropic}, cosTheta, 2048, phi);
                    EXPECT_LE(with.energy.r, 1.005 + 4 * with.energySigma)
                        << alpha << ' ' << strength << ' ' << cosTheta << ' ' << phi;
                    EXPECT_EQ(with.energy.r, without.energy.r);
                }
}

TEST_F(BsdfVariantsTest, FullFilmsAreSound) {
    for (const LobeRow& r : filmRows()) {
        expectSoundLobe(r);
        LobeRow compensated = r;
        compensated.features |= kCompensated;
        // Wider than 1.005: compensation describes a film by scaled tables of a plain interface.
        expectEnergy(compensated, 1.01);
        for (const double cosTheta : {0.2, 0.8}) expectChiSquare(r, cosTheta);
    }
}

// Airy's sum for both polarisations at three wavelengths, exact where the extension has Gaussians and
// Schlick: the colours agree as far as three wavelengths stand for colours.
double airy(double cosTheta, double film, double base, double thickness, double wavelength) {
    const double s2 = 1 - cosTheta * cosTheta, c1 = std::sqrt(1 - s2 / (film * film)),
                 c2 = std::sqrt(1 - s2 / (base * base));
    const std::complex<double> turn =
        std::polar(1.0, 4 * std::acos(-1.0) * film * thickness * c1 / wavelength);
    double sum = 0;
    for (const bool parallel : {false, true}) {
        const double a = parallel ? (film * cosTheta - c1) / (film * cosTheta + c1)
                                  : (cosTheta - film * c1) / (cosTheta + film * c1);
        const double b = parallel ? (base * c1 - film * c2) / (base * c1 + film * c2)
                                  : (film * c1 - base * c2) / (film * c1 + base * c2);
        sum += std::norm((a + b * turn) / (1.0 + a * b * turn)) / 2;
    }
    return sum;
}

TEST_F(BsdfVariantsTest, AFilmInterferesAsAirysSumSays) {
    for (const float thickness : {120.f, 200.f, 300.f, 400.f}) {
        const ProbeMaterial m{.baseColor = glm::vec3(0),
                              .alpha = 0,
                              .ior = 1.5f,
                              .iridescence = 1,
                              .iridescenceIor = 2.f,
                              .iridescenceThickness = thickness};
        const glm::dvec3 color = albedo({"film", m, kFilm}, 1, 4096).mean;
        // Luminance over the band of green, which Gaussians resolve well.
        double exact = 0;
        for (int i = 0; i < 60; ++i) exact += airy(1, 2, 1.5, thickness, 505 + i * 2) / 60;
        EXPECT_NEAR(glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722)), exact, 0.035) << thickness;
    }
}

TEST_F(BsdfVariantsTest, AFilmOfNoThicknessIsNotThere) {
    const ProbeMaterial bare{.baseColor = {.9f, .6f, .3f}, .metallic = 1, .alpha = 0};
    ProbeMaterial thin = bare;
    thin.iridescence = 1;
    thin.iridescenceThickness = 0;
    EXPECT_EQ(albedo({"bare", bare, kFacets}, 0.5, 256).mean, albedo({"thin", thin, kFilm}, 0.5, 256).mean);
}

}  // namespace
}  // namespace tilefarm
