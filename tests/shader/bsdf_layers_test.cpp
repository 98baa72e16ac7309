// Clearcoat, sheen, and the diffuse bases other than Lambert's: every lobe alone over black, then stacks.
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_checks.h"
#include "worker/render/layer_tables.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr uint64_t bits(std::initializer_list<uint32_t> features) {
    uint64_t mask = 0;
    for (const uint32_t feature : features) mask |= gpu::bit(feature);
    return mask;
}

constexpr uint64_t kCoat = bits({gpu::FEATURE_CLEARCOAT, gpu::FEATURE_GTR1});
constexpr uint64_t kSheen = bits({gpu::FEATURE_SHEEN});
constexpr uint64_t kDisneySheen = bits({gpu::FEATURE_DISNEY_SHEEN});
constexpr uint64_t kDisneyDiffuse = bits({gpu::FEATURE_DISNEY_DIFFUSE});
constexpr uint64_t kOrenNayar = bits({gpu::FEATURE_OREN_NAYAR});
constexpr uint64_t kBack = bits({gpu::FEATURE_DIFFUSE_TRANSMISSION});
constexpr uint64_t kFacets = bits({gpu::FEATURE_SPECULAR, gpu::FEATURE_MIRROR, gpu::FEATURE_TRANSMISSION});
constexpr uint64_t kEverything =
    kCoat | kSheen | kDisneySheen | kDisneyDiffuse | kOrenNayar | kBack | kFacets;
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);
constexpr auto kGtr1 = static_cast<float>(gpu::MATERIAL_GTR1 | gpu::MATERIAL_THIN);
constexpr auto kDisney = static_cast<float>(gpu::MATERIAL_DISNEY_DIFFUSE | gpu::MATERIAL_THIN);

constexpr glm::vec3 kBlack{0};

LobeRow coat(float alpha, float flags = kThin) {
    return {"coat " + std::to_string(alpha) + (flags == kGtr1 ? " GTR1" : ""),
            {.baseColor = kBlack,
             .alpha =
                 flags == kGtr1 ? std::sqrt(alpha) : alpha,  // the scale of the χ² histogram; GTR1 has a tail
             .ior = 1,
             .flags = flags,
             .clearcoat = 1,
             .clearcoatAlpha = alpha},
            kCoat};
}

LobeRow tiltedCoat(float alpha) {
    LobeRow row = coat(alpha);
    row.name += " tilted";
    row.material.clearcoatNormal = directionAt(0.96, 1.1);
    return row;
}

LobeRow sheen(float roughness) {
    return {"sheen " + std::to_string(roughness),
            {.baseColor = kBlack,
             .ior = 1,
             .flags = kThin,
             .sheenRoughness = roughness,
             .sheenColor = {1, 0.7f, 0.3f}},
            kSheen};
}

LobeRow disneySheen(float tint, const glm::vec3& base) {
    return {"Disney sheen " + std::to_string(tint),
            {.baseColor = base, .ior = 1, .flags = kThin, .disneySheen = 1, .disneySheenTint = tint},
            kDisneySheen};
}

LobeRow disneyDiffuse(float roughness, float subsurface, const glm::vec3& base = glm::vec3(1)) {
    return {"Disney diffuse " + std::to_string(roughness) + " subsurface " + std::to_string(subsurface),
            {.baseColor = base,
             .alpha = roughness * roughness,
             .ior = 1,
             .flags = kDisney,
             .subsurface = subsurface},
            kDisneyDiffuse};
}

LobeRow orenNayar(float sigma, const glm::vec3& base = glm::vec3(1)) {
    return {"Oren-Nayar " + std::to_string(sigma),
            {.baseColor = base, .ior = 1, .flags = kThin, .orenNayarSigma = sigma},
            kOrenNayar};
}

LobeRow leaf(float factor) {
    return {"leaf " + std::to_string(factor),
            {.baseColor = {.3f, .6f, .1f},
             .ior = 1,
             .flags = kThin,
             .diffuseTransmissionColor = {.9f, .8f, .2f},
             .diffuseTransmission = factor},
            kBack};
}

std::vector<LobeRow> lobes() {
    std::vector<LobeRow> rows;
    for (const float alpha : {0.01f, 0.1f, 0.4f, 1.f}) rows.push_back(coat(alpha));
    for (const float alpha : {0.001f, 0.03f, 0.1f, 0.5f, 1.f}) rows.push_back(coat(alpha, kGtr1));
    for (const float roughness : {0.f, 0.1f, 0.3f, 0.6f, 1.f}) rows.push_back(sheen(roughness));
    rows.push_back(disneySheen(0, kBlack));
    for (const float roughness : {0.f, 0.5f, 1.f})
        for (const float subsurface : {0.f, 0.5f, 1.f}) rows.push_back(disneyDiffuse(roughness, subsurface));
    for (const float sigma : {1e-4f, 0.2f, 0.6f, 1.5f}) {
        rows.push_back(orenNayar(sigma));
        rows.push_back(orenNayar(sigma, {.8f, .3f, .05f}));
    }
    rows.push_back(leaf(0.3f));
    rows.push_back(leaf(1));
    return rows;
}

class BsdfLayersTest : public LobeTest {
protected:
    /// BSDF without the cosine, red.
    double value(const LobeRow& row, const glm::vec3& wo, const glm::vec3& wi) {
        return double{probe(row.features).ask({evalQuery(row.material, wo, wi)})[0].value.x} / std::abs(wi.z);
    }
};

TEST_F(BsdfLayersTest, EveryLobeAloneIsSound) {
    for (const LobeRow& row : lobes()) expectSoundLobe(row);
    // Against the base's cosine a coat with a normal of its own is not reciprocal, like any shading normal.
    expectSoundLobe(tiltedCoat(0.2f), false);
}

TEST_F(BsdfLayersTest, DirectionsFollowThePdf) {
    for (const double cosTheta : {0.0175, 0.1, 0.6, 0.95, 1.0}) {
        for (const float alpha : {0.001f, 0.02f, 0.1f, 0.4f, 1.f}) {
            expectChiSquare(coat(alpha), cosTheta);
            expectChiSquare(coat(alpha, kGtr1), cosTheta);
        }
        for (const LobeRow& row : {tiltedCoat(0.5f), sheen(0.1f), sheen(0.7f), disneySheen(0, kBlack),
                                   disneyDiffuse(0.5f, 0.5f), orenNayar(0.5f), leaf(0.4f)})
            expectChiSquare(row, cosTheta);
    }
}

TEST_F(BsdfLayersTest, MirrorCoatReflectsByFresnelAndRoughOneTendsToIt) {
    const LobeRow mirror = coat(0), nearly = coat(1.1e-3f);
    for (const double cosTheta : {0.1, 0.5, 1.0}) {
        const double t = std::sqrt(1 - (1 - cosTheta * cosTheta) / 2.25);
        const double fresnel = 0.5 * (std::pow((1.5 * cosTheta - t) / (1.5 * cosTheta + t), 2) +
                                      std::pow((cosTheta - 1.5 * t) / (cosTheta + 1.5 * t), 2));
        EXPECT_NEAR(albedo(mirror, cosTheta, 256).mean.x, fresnel, 1e-5);
        EXPECT_NEAR(albedo(nearly, cosTheta, 4096).mean.x, fresnel, 1e-3);
    }
}

TEST_F(BsdfLayersTest, LobesReflectWhatTheirTablesSay) {
    for (const double cosTheta : {0.05, 0.3, 0.8}) {
        for (const float alpha : {0.001f, 0.05f, 0.1f, 0.5f}) {
            const Moments m = albedo(coat(alpha, kGtr1), cosTheta, 40000);
            EXPECT_NEAR(m.mean.x, gtr1Albedo(cosTheta, alpha), 4 * m.sigma + 2e-3)
                << alpha << " at " << cosTheta;
        }
        for (const float roughness : {0.3f, 0.5f, 1.f}) {
            const Moments m = albedo(sheen(roughness), cosTheta, 40000);
            EXPECT_NEAR(m.mean.x, sheenAlbedo(cosTheta, roughness), 4 * m.sigma + 2e-3)
                << roughness << " at " << cosTheta;
        }
    }
}

// Burley's formula where it gains no energy, and no more than 1 where it would.
TEST_F(BsdfLayersTest, DisneyDiffuseIsBurleysFormulaWhereThatKeepsEnergy) {
    const auto shape = [](double f90, double l, double v) {
        return (1 + (f90 - 1) * std::pow(1 - l, 5)) * (1 + (f90 - 1) * std::pow(1 - v, 5));
    };
    for (const float roughness : {0.1f, 0.5f, 1.f})
        for (const float subsurface : {0.f, 0.6f})
            for (const double phi : {0.0, 2.0, 3.1}) {
                const glm::vec3 wo = directionAt(0.8, 0), wi = directionAt(0.7, phi);
                const double cosSquared = 0.5 + 0.5 * glm::dot(glm::dvec3(wo), glm::dvec3(wi));
                const double fd = shape(0.5 + 2 * roughness * cosSquared, 0.7, 0.8);
                const double fss = shape(roughness * cosSquared, 0.7, 0.8);
                const double ss = 1.25 * (fss * (1 / (0.7 + 0.8) - 0.5) + 0.5);
                const double burley = ((1 - subsurface) * fd + subsurface * ss) / pi;
                // From roughness 0.5 on, or with subsurface, the albedo at these angles is up to 1.05 and
                // divided out.
                EXPECT_NEAR(value(disneyDiffuse(roughness, subsurface), wo, wi), burley,
                            (roughness > 0.1f || subsurface > 0 ? 0.05 : 1e-5) * burley);
            }
    // Burley's own reflects 1.55 here. What is left of it is close to 1, not merely below.
    const Moments grazing = albedo(disneyDiffuse(1, 0), 0.01, 40000);
    EXPECT_NEAR(grazing.mean.x, 1, 0.02);
}

TEST_F(BsdfLayersTest, OrenNayarOfWhiteReturnsAllLight) {
    for (const double cosTheta : {0.02, 0.3, 0.7, 1.0})
        for (const float sigma : {1e-4f, 0.1f, 0.4f, 0.8f, 1.5f}) {
            const Moments m = albedo(orenNayar(sigma), cosTheta, 40000);
            EXPECT_NEAR(m.mean.x, 1, 4 * m.sigma + 1e-3) << sigma << " at " << cosTheta;
        }
}

// Dark surfaces hardly scatter twice, so there the classic qualitative model (1994, eq. 30) must come out:
// within 3 % ahead and, because Fujii's term goes on to fall behind (cosφ < 0), within 10 % in albedo.
TEST_F(BsdfLayersTest, OrenNayarOfDarkIsTheClassicModel) {
    for (const float sigma : {0.1f, 0.3f, 0.5f}) {
        const double s2 = double{sigma} * sigma, a = 1 - 0.5 * s2 / (s2 + 0.33), b = 0.45 * s2 / (s2 + 0.09);
        const LobeRow row = orenNayar(sigma, glm::vec3(0.1f));
        double classicAlbedo = 0;
        constexpr int n = 40;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double z = std::sqrt((i + 0.5) / n), phi = pi * (j + 0.5) / n;
                const double to = std::acos(0.5), ti = std::acos(z);
                const double classic = a + b * std::max(0.0, std::cos(phi)) * std::sin(std::max(to, ti)) *
                                               std::tan(std::min(to, ti));
                classicAlbedo += 0.1 * classic / (n * n);
                if (phi < pi / 2 && i % 8 == 0 && j % 8 == 0) {
                    EXPECT_NEAR(value(row, directionAt(0.5, 0), directionAt(z, phi)), 0.1 / pi * classic,
                                0.03 * 0.1 / pi * classic)
                        << "sigma " << sigma << " cos " << z << " phi " << phi;
                }
            }
        const Moments m = albedo(row, 0.5, 40000);
        EXPECT_NEAR(m.mean.x, classicAlbedo, 0.1 * classicAlbedo) << sigma;
    }
}

TEST_F(BsdfLayersTest, LeafSplitsLightBetweenItsSides) {
    const Moments m = albedo(leaf(0.3f), 0.6, 40000);
    EXPECT_NEAR(m.transmitted.x, 0.3 * 0.9, 4 * m.sigma + 1e-3);
    EXPECT_NEAR(m.mean.x - m.transmitted.x, 0.7 * 0.3, 4 * m.sigma + 1e-3);
}

TEST_F(BsdfLayersTest, LayersOverWhiteReturnAllLight) {
    for (const double cosTheta : {0.05, 0.3, 0.8, 1.0})
        for (const LobeRow& layer : {coat(0), coat(0.1f), coat(0.1f, kGtr1), sheen(0.3f), sheen(0.8f)}) {
            LobeRow row = layer;
            row.material.baseColor = glm::vec3(1);
            const Moments m = albedo(row, cosTheta, 40000);
            EXPECT_NEAR(m.mean.x, 1, 4 * m.sigma + 3e-3) << row.name << " at cos " << cosTheta;
        }
}

TEST_F(BsdfLayersTest, FullStacksKeepTheirEnergy) {
    const ProbeMaterial all{.metallic = 0,
                            .alpha = 0.09f,
                            .flags = kDisney,
                            .clearcoat = 1,
                            .clearcoatAlpha = 0.01f,
                            .sheenRoughness = 0.5f,
                            .disneySheen = 1,
                            .sheenColor = {1, 1, 1},
                            .diffuseTransmission = 0.5f,
                            .subsurface = 0.5f};
    std::vector<LobeRow> rows;
    const auto add = [&](const char* name, auto change) {
        LobeRow row{name, all, kEverything};
        change(row.material);
        rows.push_back(row);
    };
    add("all", [](ProbeMaterial&) {});
    add("rough", [](ProbeMaterial& m) { m.alpha = 1, m.clearcoatAlpha = 0.5f, m.sheenRoughness = 1; });
    add("smooth cloth", [](ProbeMaterial& m) { m.sheenRoughness = 0.1f, m.clearcoat = 0; });
    add("GTR1 over metal",
        [](ProbeMaterial& m) { m.flags = kGtr1, m.metallic = 1, m.clearcoatAlpha = 0.1f; });
    add("Oren-Nayar plastic", [](ProbeMaterial& m) {
        m.flags = kThin, m.orenNayarSigma = 1, m.clearcoat = 0, m.sheenColor = glm::vec3(0),
        m.disneySheen = 0;
    });
    add("subsurface plastic", [](ProbeMaterial& m) {
        m.subsurface = 1, m.clearcoat = 0, m.sheenColor = glm::vec3(0), m.disneySheen = 0;
    });
    add("coated glass", [](ProbeMaterial& m) { m.flags = 0, m.transmission = 1, m.diffuseTransmission = 0; });
    for (const LobeRow& row : rows) {
        expectEnergy(row);
        expectAgreement(row);
        expectFinite(row);
    }
}

// Principled parameters at random: what they have in common is that no light comes from nothing.
ProbeMaterial randomMaterial(std::mt19937& random) {
    std::uniform_real_distribution<float> uniform(0, 1);
    // Often nothing, often everything, else in between.
    const auto weight = [&] {
        const float u = uniform(random);
        return u < 0.4f ? 0.f : u < 0.6f ? 1.f : uniform(random);
    };
    const auto color = [&] {
        return uniform(random) < 0.5f ? glm::vec3(1) : glm::vec3(weight(), weight(), weight());
    };
    ProbeMaterial m;
    m.baseColor = color();
    m.metallic = weight();
    m.alpha = weight();
    m.ior = std::array{1.f, 1.1f, 1.5f, 2.f}[random() % 4];
    m.transmission = weight();
    if (m.transmission > 0)
        m.ior = std::max(m.ior, 1.1f);  // glass of index 1 scatters into a single direction
    m.flags = (random() % 2 != 0 ? kThin : 0.f) + (random() % 2 != 0 ? float(gpu::MATERIAL_GTR1) : 0.f) +
              (random() % 2 != 0 ? float(gpu::MATERIAL_DISNEY_DIFFUSE) : 0.f);
    m.clearcoat = weight();
    m.clearcoatAlpha = weight();
    if (random() % 4 == 0) m.clearcoatNormal = directionAt(0.9 + 0.1 * uniform(random), 6 * uniform(random));
    m.sheenColor = weight() * color();
    m.sheenRoughness = weight();
    m.disneySheen = weight();
    m.disneySheenTint = weight();
    m.diffuseTransmission = weight();
    m.diffuseTransmissionColor = color();
    m.subsurface = weight();
    m.orenNayarSigma = 1.5f * weight();
    return m;
}

std::string describe(const ProbeMaterial& m) {
    std::ostringstream out;
    out << "base " << m.baseColor.x << ' ' << m.baseColor.y << ' ' << m.baseColor.z << ", metallic "
        << m.metallic << ", alpha " << m.alpha << ", ior " << m.ior << ", transmission " << m.transmission
        << ", flags " << m.flags << ", coat " << m.clearcoat << ' ' << m.clearcoatAlpha << " normal z "
        << m.clearcoatNormal.z << ", sheen " << m.sheenColor.x << ' ' << m.sheenRoughness << ", Disney sheen "
        << m.disneySheen << ", back " << m.diffuseTransmission << ", subsurface " << m.subsurface
        << ", sigma " << m.orenNayarSigma;
    return out.str();
}

TEST_F(BsdfLayersTest, RandomStacksNeitherGainEnergyNorLoseTheirPdf) {
    constexpr int kMaterials = 10000, kDraws = 64;
    std::mt19937 random(17);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int batch = 0; batch < 10; ++batch) {
        std::vector<BsdfQuery> draws, points;
        std::vector<ProbeMaterial> materials;
        for (int i = 0; i < kMaterials / 10; ++i) {
            materials.push_back(randomMaterial(random));
            const glm::vec3 wo = directionAt(0.02 + 0.98 * uniform(random), 6 * uniform(random));
            for (int k = 0; k < kDraws; ++k) {
                const float x = (float(k % 8) + uniform(random)) / 8,
                            y = (float(k / 8) + uniform(random)) / 8;
                draws.push_back(drawQuery(materials.back(), wo, {uniform(random), x, y}));
                glm::vec3 wi = directionAt(std::abs(2 * x - 1), 2 * pi * y);
                if (x < 0.5f) wi.z = -wi.z;
                points.push_back(evalQuery(materials.back(), wo, wi));
            }
        }
        const auto drawn = probe(kEverything).ask(draws), pdfs = probe(kEverything).ask(points);
        for (size_t i = 0; i < materials.size(); ++i) {
            glm::dvec3 energy(0), squares(0);
            double pdf = 0, pdfSquares = 0;
            for (size_t k = i * kDraws; k < (i + 1) * kDraws; ++k) {
                glm::dvec3 weight(drawn[k].value);
                const double eta = materials[i].frontFace != 0 ? materials[i].ior : 1 / materials[i].ior;
                const bool refracts = drawn[k].wi.z < 0 && materials[i].transmission > 0 &&
                                      (uint32_t(materials[i].flags) & gpu::MATERIAL_THIN) == 0;
                if (refracts && materials[i].diffuseTransmission == 0) weight *= eta * eta;
                ASSERT_TRUE(std::isfinite(weight.x + weight.y + weight.z) && std::isfinite(drawn[k].wi.w));
                ASSERT_TRUE(std::isfinite(pdfs[k].wi.w) && pdfs[k].wi.w >= 0);
                energy += weight;
                squares += weight * weight;
                pdf += 4 * pi * pdfs[k].wi.w;
                pdfSquares += std::pow(4 * pi * pdfs[k].wi.w, 2);
            }
            for (int c = 0; c < 3; ++c) {
                const double mean = energy[c] / kDraws;
                const double sigma = std::sqrt(std::max(squares[c] / kDraws - mean * mean, 0.0) / kDraws);
                // 3e4 tests at five sigma; the distribution of so few weights has a tail.
                EXPECT_LE(mean, 1.005 + 5 * sigma + 0.02) << describe(materials[i]);
            }
            const double mean = pdf / kDraws;
            const double sigma = std::sqrt(std::max(pdfSquares / kDraws - mean * mean, 0.0) / kDraws);
            EXPECT_LE(mean, 1.01 + 5 * sigma) << describe(materials[i]);
        }
    }
}

}  // namespace
}  // namespace tilefarm
