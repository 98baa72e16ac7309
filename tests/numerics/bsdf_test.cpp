// Cases 20 to 25: the scattering functions through the shaders' own code, by the checks that every lobe has
// (tests/shader/lobe_checks.h), at the roughnesses and angles where they break.
#include <cmath>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/statistics.h"
#include "tests/property/furnace.h"
#include "tests/shader/lobe_checks.h"
#include "worker/render/albedo_table.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
constexpr uint64_t kCompensation = gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
constexpr uint64_t kLayers = kFacets | gpu::bit(gpu::FEATURE_CLEARCOAT) | gpu::bit(gpu::FEATURE_SHEEN) |
                             gpu::bit(gpu::FEATURE_DIFFUSE_TRANSMISSION);

LobeRow metal(float alpha) {
    return {"metal", {.metallic = 1, .alpha = alpha}, kFacets};
}
LobeRow glass(float alpha, bool inside = false) {
    return {inside ? "glass inside" : "glass",
            {.alpha = alpha, .transmission = 1, .frontFace = inside ? 0.f : 1.f},
            kFacets};
}
LobeRow plastic(float alpha) {
    return {"plastic", {.baseColor = {.8f, .5f, .2f}, .alpha = alpha}, kFacets};
}
LobeRow coated(float alpha) {
    return {"coated", {.alpha = 0.4f, .clearcoat = 1, .clearcoatAlpha = alpha}, kLayers};
}
LobeRow cloth(float roughness) {
    return {"cloth", {.alpha = 0.5f, .sheenRoughness = roughness, .sheenColor = glm::vec3(0.8f)}, kLayers};
}
LobeRow leaf() {
    return {"leaf", {.alpha = 0.3f, .diffuseTransmission = 0.5f}, kLayers};
}

std::vector<LobeRow> lobesAt(float alpha) {
    return {metal(alpha), glass(alpha), glass(alpha, true), plastic(alpha), coated(alpha)};
}

class HardLobe : public LobeTest {
protected:
    BsdfAnswer evaluate(const LobeRow& row, const glm::vec3& wo, const glm::vec3& wi) {
        return probe(row.features).ask({evalQuery(row.material, wo, wi)}).front();
    }
};

TEST_F(HardLobe, HardCase20_WhiteFurnace) {
    const Moments lambert = albedo({"matte", {.alpha = 1, .ior = 1}, 0}, 0.6, 4096);
    EXPECT_NEAR(lambert.mean.x, 1, 1e-3);
    for (const double cosTheta : {0.1, 0.5, 1.0})
        for (const float alpha : {0.02f, 0.3f, 1.0f}) {
            const Moments m = albedo(metal(alpha), cosTheta);
            // The table's own quadrature in double, of an index that reflects everything.
            expectMean({m.mean.x, m.sigma}, reflectionAlbedo(cosTheta, alpha, 1e9), 0.005);
        }
}

/// Any material whatever (tests/property/any_material.h): no more light leaves it than comes. What cannot be
/// told from the bound is looked at again with more samples.
void expectRandomMaterialsToKeepEnergy(BsdfProbe& probe, size_t count, Variety variety,
                                       const FurnaceEffort& effort, const std::vector<float>& cosines) {
    std::vector<SeenMaterial> materials;
    for (size_t i = 0; i < count; ++i) {
        materials.push_back(materialNumber(i, variety));
        for (const float cosTheta : cosines) {
            SeenMaterial other = materialNumber(i, variety);
            other.wo = directionAt(double{cosTheta}, double(i));
            materials.push_back(other);
        }
    }
    const auto furnaces = furnace(probe, materials, effort);
    int shown = 0;
    for (size_t i = 0; i < materials.size(); ++i) {
        const Furnace& f = furnaces[i];
        const double most = std::max({f.energy.x, f.energy.y, f.energy.z}),
                     sigma = std::max({f.sigma.x, f.sigma.y, f.sigma.z});
        recordWorst("sigma", sigma);
        const bool bounded = keepsEnergyTo1005(materials[i].material);
        if (sigma < 1e-3 && bounded) recordWorst("energy", most);
        if ((!(f.tooMuch && bounded) && f.unsound == 0) || ++shown > 10) continue;
        ADD_FAILURE() << "material " << i / (cosines.size() + 1) << " returns " << most << " ± " << sigma
                      << ", " << f.unsound << " samples not finite: " << materials[i];
    }
}

/// What random materials found, made plain; each returned the share of light in brackets.
std::vector<SeenMaterial> materialsThatGaveTooMuch() {
    const auto wo = [](double cosTheta, double phi = 0) { return directionAt(cosTheta, phi); };
    const glm::vec3 white(1);
    const auto kPhong = static_cast<float>(gpu::MATERIAL_PHONG);
    return {
        // Mirrors looked up as if they were a little rough, base and coat [1.09, 1.12].
        {{.baseColor = white, .alpha = 5.6e-4f}, wo(1e-3)},
        {{.baseColor = white, .clearcoat = 1, .clearcoatAlpha = 9.99e-4f}, wo(1e-3)},
        // h · wo of grazing directions cancelled: directions drawn by a lobe of which the pdf knew nothing
        // [1e11, 1.04].
        {{.baseColor = white, .clearcoat = 1, .clearcoatAlpha = 1e-3f}, wo(1e-7)},
        {{.baseColor = white, .alpha = 1e-3f, .disneySheen = 1}, {-0.97831738f, -0.207111374f, 1e-5f}},
        // Tables of albedos too coarse where cosθ meets α, and of sheen [1.01, 1.09, 1.01, 1.01].
        {{.baseColor = white, .alpha = 2e-3f}, wo(0.01)},
        {{.baseColor = white, .sheenRoughness = 0, .sheenColor = white}, wo(1e-3)},
        {{.baseColor = white, .sheenRoughness = 1, .sheenColor = white}, wo(1e-7)},
        {{.baseColor = white, .sheenRoughness = 1, .sheenColor = white}, wo(2e-3)},
        // Isotropic albedos under stretched facets, seen across the grooves [1.21, 1.08].
        {{.baseColor = white, .alpha = 0.25f, .alphaT = 1}, wo(1e-7, pi / 2)},
        {{.baseColor = white, .alpha = 0.25f, .alphaT = 1}, wo(0.1, pi / 2)},
        // And along grooves that are rough across [1.05].
        {{.baseColor = white, .alpha = 2e-3f, .alphaT = 0.98f, .ior = 1.33f}, wo(1e-5, 1.54)},
        // The rim of an index near 1, within the table's first column [1.015].
        {{.baseColor = white, .alpha = 0, .ior = 1.0001f}, wo(1e-4)},
        // Films above what a plain interface's tables bound, with a base of index 1 among them
        // [1.09, 1.26, 1.02].
        {{.baseColor = white, .alpha = 0, .iridescence = 1, .iridescenceThickness = 400}, wo(0.12)},
        {{.baseColor = white, .ior = 1, .iridescence = 1, .iridescenceThickness = 400}, wo(1e-3)},
        {{.alpha = 0.25f,
          .transmission = 1,
          .iridescence = 1,
          .iridescenceIor = 3,
          .iridescenceThickness = 400},
         wo(1)},
        // A film's red, which swings further than its amplitudes [1.02].
        {{.baseColor = white,
          .alpha = 1,
          .specularColor = {19, 1, 1},
          .iridescence = 0.62f,
          .iridescenceIor = 2.14f,
          .iridescenceThickness = 420},
         wo(0.22)},
        // Phong's facets drawn as if they were stretched [1.01].
        {{.alpha = 0, .alphaT = 0.005f, .transmission = 1, .flags = kPhong}, wo(0.67)},
        // Dispersed channels with the tables of the mean index [1.02].
        {{.alpha = 1, .transmission = 1, .dispersion = 8}, wo(1)},
        // Dark specular colours on a high index, whose curve magnified the tables' digits [2.6], and a bright
        // one whose
        // base got light divided by next to nothing [6.1].
        {{.alpha = 0.16f,
          .alphaT = 0.25f,
          .ior = 1000,
          .transmission = 0.43f,
          .frontFace = 0,
          .specularColor = glm::vec3(0.34f)},
         wo(0.1)},
        {{.baseColor = white,
          .alphaT = 0.2f,
          .flags = kPhong,
          .specularColor = {1, 30, 1},
          .iridescence = 1,
          .iridescenceThickness = 1},
         wo(0.11)},
    };
}

TEST_F(HardLobe, HardCase20_MaterialsThatGaveTooMuch) {
    const auto materials = materialsThatGaveTooMuch();
    const auto furnaces =
        furnace(probe(everyLobe() | kCompensation), materials, {.first = 1024, .last = 1u << 16});
    for (size_t i = 0; i < materials.size(); ++i) {
        const double most = std::max({furnaces[i].energy.x, furnaces[i].energy.y, furnaces[i].energy.z});
        EXPECT_FALSE(furnaces[i].tooMuch) << most << " of " << materials[i];
        EXPECT_EQ(furnaces[i].unsound, 0) << materials[i];
    }
}

TEST_F(HardLobe, HardCase20_RandomMaterials) {
    expectRandomMaterialsToKeepEnergy(probe(everyLobe() | kCompensation), 500, Variety::few,
                                      {.first = 512, .last = 1u << 16}, {});
}
TEST_F(HardLobe, FullHardCase20_RandomMaterials) {
    expectRandomMaterialsToKeepEnergy(probe(everyLobe() | kCompensation), 10'000, Variety::many, {},
                                      {1e-3f, 0.1f, 0.5f, 1.0f});
}
TEST_F(HardLobe, FullHardCase20_RandomMaterialsOfFacetsThatScatterOnce) {
    expectRandomMaterialsToKeepEnergy(probe(everyLobe()), 10'000, Variety::few,
                                      {.first = 512, .last = 1u << 18}, {});
}

TEST_F(HardLobe, HardCase24_LastRandomNumberChoosesNoLobeWithoutAChance) {
    // Sheen keeps all light from the mirror below, whose chance is 0, and the chances' sum rounds to less
    // than 1: the mirror was chosen and its weight 0 / 0, one sample in 2^24.
    const ProbeMaterial m{.baseColor = glm::vec3(0.467532456f),
                          .alpha = 0.00023713737f,
                          .ior = 1.1f,
                          .flags = float(gpu::MATERIAL_THIN),
                          .specularColor = {0, 1, 1},
                          .iridescence = 0.062337663f,
                          .iridescenceThickness = 816.623352f,
                          .clearcoat = 0.867532492f,
                          .clearcoatAlpha = 0.25f,
                          .sheenColor = {1, 0, 0},
                          .orenNayarSigma = 1.57f};
    const glm::vec3 wo(0.928506076f, 0.371317208f, 1e-7f);
    const BsdfAnswer a = probe(everyLobe() | kCompensation)
                             .ask({drawQuery(m, wo, {0.99999994f, 0.363567591f, 0.158393249f})})
                             .front();
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(a.value[c])) << a.value[c];
}

// fp64: the distribution of normals and Smith's masking of GGX.
double exactD(double cosTheta, double alpha) {
    const double a2 = alpha * alpha, s = a2 * cosTheta * cosTheta + (1 - cosTheta) * (1 + cosTheta);
    return a2 / (pi * s * s);
}
double exactG1(double z, double alpha) {
    return 2 * z / (z + std::sqrt(z * z + alpha * alpha * (1 - z) * (1 + z)));
}

TEST_F(HardLobe, HardCase21_WeakFurnace) {
    // ∫ G1 D |wo·m| dm = cosθ, that is: visible normals have the density 1. Over the normals whose reflection
    // stays above the surface the kernel's pdf is asked; the rest, which it never evaluates, is added in
    // double.
    constexpr int kRadial = 400, kAround = 96;
    for (const float alpha : {0.1f, 0.4f, 1.0f})
        for (const double cosTheta : {0.2, 0.6, 0.95}) {
            const glm::dvec3 wo(directionAt(cosTheta, 0));
            const LobeRow row = metal(alpha);
            std::vector<BsdfQuery> queries;
            std::vector<double> weights;
            double sum = 0;
            for (int i = 0; i < kRadial; ++i)
                for (int j = 0; j < kAround; ++j) {
                    // Slopes: tanθ = α x / (1 − x), midpoints.
                    const double x = (i + .5) / kRadial, phi = 2 * pi * (j + .5) / kAround;
                    const double tangent = double{alpha} * x / (1 - x),
                                 z = 1 / std::sqrt(1 + tangent * tangent);
                    const glm::dvec3 m(tangent * z * std::cos(phi), tangent * z * std::sin(phi), z);
                    const double solid = double{alpha} / ((1 - x) * (1 - x)) * tangent * z * z * z *
                                         (2 * pi / kAround) / kRadial;
                    const double facing = glm::dot(wo, m);
                    if (facing <= 0) continue;
                    const glm::dvec3 wi = 2 * facing * m - wo;
                    if (wi.z > 1e-4) {
                        queries.push_back(evalQuery(row.material, glm::vec3(wo), glm::vec3(wi)));
                        weights.push_back(solid * 4 * facing);  // from dwi back to dm
                    } else {
                        sum += exactG1(cosTheta, alpha) * exactD(z, alpha) * facing / cosTheta * solid;
                    }
                }
            const auto answers = probe(row.features).ask(queries);
            double byKernel = 0;
            for (size_t i = 0; i < answers.size(); ++i) byKernel += double{answers[i].wi.w} * weights[i];
            EXPECT_GT(byKernel, 0.4) << "mostly the kernel's";
            recordWorst("off", std::abs(sum + byKernel - 1));
            EXPECT_NEAR(sum + byKernel, 1, 1e-4) << "alpha " << alpha << " cos " << cosTheta;
        }
}

TEST_F(HardLobe, HardCase22_BlackMetalReflectsTowardsItsNormal) {
    // Black reflects nothing along the normal, for which its facets were left out there, not the other way
    // round.
    LobeRow black = metal(0.03f);
    black.material.baseColor = glm::vec3(0);
    const glm::vec3 n(0, 0, 1), w = directionAt(0.09);
    const double there = double{evaluate(black, n, w).value.x} / double{w.z},
                 back = double{evaluate(black, w, n).value.x};
    EXPECT_GT(back, 0);
    EXPECT_NEAR(there, back, 1e-4 * back);
}

TEST_F(HardLobe, HardCase23_RoughnessTowardsZero) {
    double last = 0;
    for (const float alpha : {1.0f, 0.3f, 0.1f, 0.03f, 0.01f, 3e-3f, 1e-3f}) {
        // At h = n with both directions there: D G / 4, G = 1.
        const glm::vec3 n(0, 0, 1);
        const double peak = double{evaluate(metal(alpha), n, n).value.x}, a = double{alpha};
        EXPECT_NEAR(4 * peak, 1 / (pi * a * a), 1e-5 / (pi * a * a)) << alpha;
        EXPECT_GT(peak, last) << "a smoother surface has the higher highlight";
        last = peak;
        // At tanθ = α, both directions in the normal's: D V cosθ with the V of both stretches alike.
        const double z = 1 / std::sqrt(1 + a * a);
        const glm::vec3 h = directionAt(z, 0.3);
        const double shown = double{h.z}, sine2 = double{h.x} * h.x + double{h.y} * h.y;
        const double s = a * a * shown * shown + sine2, stretch = std::sqrt(shown * shown + a * a * sine2);
        const double expected = a * a / (pi * s * s) * 0.25 / (shown * stretch) * shown;
        const double value = double{evaluate(metal(alpha), h, h).value.x};
        recordWorst("relative", std::abs(value - expected) / expected);
        EXPECT_NEAR(value, expected, 1e-5 * expected) << alpha;
    }
    // Below ALPHA_DELTA the lobe is the mirror itself, which draws one direction with the mirror's weight.
    for (const float alpha : {0.0f, 1e-6f, 9e-4f}) {
        const auto draw = [&](float a) {
            return probe(kFacets)
                .ask({drawQuery(metal(a).material, directionAt(0.4), {0.5f, 0.3f, 0.6f})})
                .front();
        };
        const BsdfAnswer mirror = draw(0), smooth = draw(alpha);
        EXPECT_EQ(mirror.value, smooth.value);
        EXPECT_EQ(mirror.wi, smooth.wi);
        EXPECT_EQ(mirror.value.w, 2) << "delta";
    }
}

TEST_F(HardLobe, HardCase24_GrazingDirections) {
    for (const float alpha : {0.0f, 1e-3f, 0.3f, 1.0f})
        for (const LobeRow& row : lobesAt(alpha)) expectFinite(row);
    expectFinite(cloth(0.1f));
    expectFinite(leaf());
    for (const float cosTheta : {1e-3f, 1e-5f, 1e-7f, 0.0f})
        for (const LobeRow& row : lobesAt(0.2f)) {
            const BsdfAnswer a = evaluate(row, directionAt(cosTheta), directionAt(cosTheta, 3.4));
            EXPECT_TRUE(std::isfinite(a.value.x) && a.value.x >= 0) << row.name << " " << cosTheta;
            EXPECT_TRUE(std::isfinite(a.wi.w) && a.wi.w >= 0) << row.name << " " << cosTheta;
        }
}

TEST_F(HardLobe, HardCase25_CriticalAngle) {
    // Every sample of a lossless interface carries all of the energy: R / p(R) = T / p(T) = R + T = 1. What
    // is off counts with the chance of its kind; p(T) = 1 − p(R) has few digits where T is small.
    const auto transmittance = [](double cosTheta) {
        const double eta = 1 / 1.5, squared = 1 - (1 - cosTheta * cosTheta) / (eta * eta);
        if (squared <= 0) return 0.0;
        const double t = std::sqrt(squared), parallel = (eta * cosTheta - t) / (eta * cosTheta + t),
                     perpendicular = (cosTheta - eta * t) / (cosTheta + eta * t);
        return 1 - 0.5 * (parallel * parallel + perpendicular * perpendicular);
    };
    const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));
    const LobeRow row = glass(0, true);
    std::vector<BsdfQuery> queries;
    for (const double delta : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7})
        for (const double side : {-1.0, 1.0})
            for (const float u : {0.0f, 0.3f, 0.9f, 0.99999994f})
                queries.push_back(
                    drawQuery(row.material, directionAt(critical + side * delta), {u, 0.5f, 0.5f}));
    size_t refracted = 0;
    const auto answers = probe(row.features).ask(queries);
    for (size_t i = 0; i < answers.size(); ++i) {
        const BsdfAnswer& a = answers[i];
        ASSERT_EQ(a.value.w, 2);
        const double chance = a.wi.z < 0 ? transmittance(double{queries[i].wo.z}) : 1;
        const double energy = double{a.value.x} * (a.wi.z < 0 ? 1 / (1.5 * 1.5) : 1);
        recordWorst("energy", chance * std::abs(energy - 1));
        EXPECT_LE(chance * std::abs(energy - 1), 1e-6);
        recordWorst("length", std::abs(glm::length(glm::dvec3(a.wi)) - 1));
        EXPECT_NEAR(glm::length(glm::dvec3(a.wi)), 1, 1e-6);
        refracted += a.wi.z < 0;
    }
    EXPECT_GT(refracted, 5u);
}

}  // namespace
}  // namespace tilefarm
