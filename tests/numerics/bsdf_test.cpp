// Cases 18 to 25: the scattering functions through the shaders' own code, by the checks that every lobe has
// (tests/shader/lobe_checks.h), at the roughnesses and angles where they break.
#include <cmath>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/statistics.h"
#include "tests/shader/lobe_checks.h"
#include "worker/render/albedo_table.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr uint64_t kFacets =
    gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
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
/// The coat alone, over nothing: a smooth one is resolved by the chart of half vectors only, which a wide
/// base lobe beside it is not.
LobeRow coatAlone(float alpha) {
    return {"coat alone",
            {.baseColor = glm::vec3(0),
             .alpha = alpha,
             .ior = 1,
             .flags = float(gpu::MATERIAL_THIN),
             .clearcoat = 1,
             .clearcoatAlpha = alpha},
            kLayers};
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

double cosine(double degrees) {
    return std::cos(degrees * pi / 180);
}

class HardLobe : public LobeTest {
protected:
    BsdfAnswer evaluate(const LobeRow& row, const glm::vec3& wo, const glm::vec3& wi) {
        return probe(row.features).ask({evalQuery(row.material, wo, wi)}).front();
    }
};

TEST_F(HardLobe, HardCase18_DirectionsFollowThePdf) {
    for (const float alpha : {1e-3f, 0.05f, 0.6f})
        for (const double degrees : {0.0, 60.0, 89.0})
            for (const LobeRow& row : {metal(alpha), glass(alpha), glass(alpha, true)})
                expectChiSquare(row, cosine(degrees));
}
TEST_F(HardLobe, FullHardCase18_DirectionsFollowThePdf) {
    for (const float alpha : {1e-3f, 0.01f, 0.05f, 0.1f, 0.3f, 0.6f, 1.0f})
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 85.0, 89.0, 89.9})
            for (LobeRow row : lobesAt(alpha)) {
                // Charts of half vectors resolve smooth facets and those of directions a wide base; neither
                // both.
                const bool mixed = row.name == "coated" || row.name == "plastic";
                if (mixed && alpha < 0.2f) {
                    if (row.name == "coated") row = coatAlone(alpha);
                    row.material.baseColor = glm::vec3(0);
                }
                expectChiSquare(row, cosine(degrees), !mixed || alpha < 0.2f);
            }
}

TEST_F(HardLobe, HardCase19_SampleEvaluationAndPdfAgree) {
    for (const float alpha : {1e-3f, 0.1f, 1.0f})
        for (const LobeRow& row : lobesAt(alpha)) expectAgreement(row);
    expectAgreement(cloth(0.3f));
    expectAgreement(leaf());
}

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

/// Any material whatever: no more light leaves it than comes.
void expectRandomMaterialsToKeepEnergy(LobeTest&, const std::function<void(const LobeRow&)>& check,
                                       int count) {
    std::mt19937 random(20);
    std::uniform_real_distribution<float> u(0, 1);
    // Half of the numbers at their limits, which is where things break.
    const auto any = [&] { return u(random) < 0.5f ? u(random) : u(random) < 0.5f ? 0.f : 1.f; };
    for (int i = 0; i < count; ++i) {
        ProbeMaterial m;
        m.baseColor = {any(), any(), any()};
        m.metallic = any();
        m.alpha = std::max(any() * any(), 1e-3f);
        m.ior = std::array{1.f, 1.1f, 1.5f, 2.4f}[random() % 4];
        m.transmission = any();
        m.frontFace = m.transmission > 0 && u(random) < 0.5f ? 0.f : 1.f;
        m.clearcoat = any();
        m.clearcoatAlpha = std::max(any() * any(), 1e-3f);
        m.sheenColor = {any(), any(), any()};
        m.sheenRoughness = 0.1f + 0.9f * u(random);
        // Only one way through at a time: `energy` takes all that passes as refracted or none of it.
        m.diffuseTransmission = m.transmission > 0 ? 0 : any();
        check({"material " + std::to_string(i), m, kLayers});
    }
}

TEST_F(HardLobe, HardCase20_RandomMaterials) {
    expectRandomMaterialsToKeepEnergy(
        *this,
        [&](const LobeRow& row) {
            for (const double cosTheta : {0.05, 0.5, 1.0}) {
                const Moments m = albedo(row, cosTheta, 4096);
                for (int c = 0; c < 3; ++c)
                    EXPECT_LE(m.energy[c], 1.005 + zLimit() * m.energySigma)
                        << row.name << " at cos " << cosTheta;
            }
        },
        60);
}
TEST_F(HardLobe, FullHardCase20_RandomMaterials) {
    expectRandomMaterialsToKeepEnergy(
        *this, [&](const LobeRow& row) { expectEnergy(row); }, 10'000);
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

TEST_F(HardLobe, HardCase22_Reciprocity) {
    // Exceptions, as their sources have them: clearcoat and sheen scale what lies below by what they take of
    // one direction alone (KHR_materials_clearcoat, KHR_materials_sheen).
    for (const float alpha : {0.05f, 0.4f})
        for (const LobeRow& row : {metal(alpha), glass(alpha), glass(alpha, true), plastic(alpha)})
            expectReciprocity(row);
    expectReciprocity(leaf());
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
