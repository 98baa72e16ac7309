// Case 18's column of mirrors: of roughness 0 a lobe draws one direction on either side, evaluation does not
// know it, and it is drawn as often as the light that it carries says, by Fresnel's equations in double.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <sstream>

#include "shaders/gpu_types.h"
#include "tests/numerics/lobe_table.h"
#include "tests/numerics/statistics.h"
#include "tests/shader/lobe_histogram.h"

namespace tilefarm {
namespace {

constexpr int kSamples = 3000;

bool has(const ProbeMaterial& m, uint32_t flag) {
    return (static_cast<uint32_t>(m.flags) & flag) != 0;
}
bool isSolid(const ProbeMaterial& m) {
    return m.transmission > 0 && !has(m, gpu::MATERIAL_THIN);
}
double etaOf(const ProbeMaterial& m) {
    return isSolid(m) && m.frontFace == 0 ? 1 / double{m.ior} : double{m.ior};
}

/// Cosine beyond the interface; 0 beyond the critical angle.
double refracted(double cosTheta, double eta) {
    return std::sqrt(std::max(0.0, 1 - (1 - cosTheta * cosTheta) / (eta * eta)));
}

double schlick(double f0, double cosTheta) {
    return f0 + (1 - f0) * std::pow(1 - cosTheta, 5);
}

double fresnel(double cosTheta, double eta) {
    const double t = refracted(cosTheta, eta);
    if (t == 0) return 1;
    const double p = (eta * cosTheta - t) / (eta * cosTheta + t),
                 s = (cosTheta - eta * t) / (cosTheta + eta * t);
    return 0.5 * (p * p + s * s);
}

double fresnelConductor(double cosTheta, double eta, double k) {
    const std::complex<double> n(eta, k), t = std::sqrt(n * n - (1 - cosTheta * cosTheta));
    return 0.5 * (std::norm((cosTheta - t) / (cosTheta + t)) +
                  std::norm((n * n * cosTheta - t) / (n * n * cosTheta + t)));
}

/// With KHR_materials_specular; films apart.
glm::dvec3 bareDielectric(const ProbeMaterial& m, double cosTheta, double eta) {
    const double f0 = std::pow((eta - 1) / (eta + 1), 2),
                 outer = eta < 1 ? refracted(cosTheta, eta) : cosTheta;
    const double curve = has(m, gpu::MATERIAL_SCHLICK) ? schlick(f0, outer) : fresnel(cosTheta, eta);
    if (curve == 1) return glm::dvec3(1);
    const glm::dvec3 kappa = (1.0 - glm::min(f0 * glm::dvec3(m.specularColor), glm::dvec3(1))) / (1 - f0);
    return double{m.specular} * glm::max(1.0 - kappa * (1 - curve), glm::dvec3(0));
}

struct Drawn {
    int count = 0;
    glm::dvec3 weight{0};
};

class HardLobeMirrors : public LobeTest {
protected:
    void expectMirror(const LobeRow& row, double degrees);
    glm::dvec3 dielectric(const LobeRow& row, double cosTheta, double eta);
    glm::dvec3 reflectance(const LobeRow& row, double cosTheta);
    glm::dvec3 transmittance(const LobeRow& row, double cosTheta);
    double chanceOf(const Drawn& drawn, const glm::dvec3& light);
    void expectNothingToEvaluate(const LobeRow& row, const glm::vec3& wo,
                                 const std::vector<glm::dvec3>& towards);
};

/// Films reflect as they do over a base that takes all other light: there they are all that is drawn. What
/// they reflect is BsdfVariantsTest's.
glm::dvec3 HardLobeMirrors::dielectric(const LobeRow& row, double cosTheta, double eta) {
    if (row.material.iridescence == 0) return bareDielectric(row.material, cosTheta, eta);
    const double outer = eta < 1 ? refracted(cosTheta, eta) : cosTheta;
    if (outer == 0) return glm::dvec3(1);
    ProbeMaterial opaque = row.material;
    opaque.baseColor = glm::vec3(0);
    opaque.transmission = opaque.metallic = 0;
    return glm::dvec3(
        probe(row.features).ask({drawQuery(opaque, directionAt(outer), {0.5f, 0.3f, 0.6f})}).front().value);
}

glm::dvec3 HardLobeMirrors::reflectance(const LobeRow& row, double cosTheta) {
    const ProbeMaterial& m = row.material;
    if (m.clearcoat > 0) return glm::dvec3(double{m.clearcoat} * fresnel(cosTheta, 1.5));
    const double eta = etaOf(m);
    glm::dvec3 r = dielectric(row, cosTheta, eta);
    // Only what transmits reflects totally.
    if (eta < 1) r = glm::mix(dielectric(row, cosTheta, 1 / eta), r, double{m.transmission});
    if (m.metallic == 0) return r;
    glm::dvec3 metal;
    for (int c = 0; c < 3; ++c)
        metal[c] = has(m, gpu::MATERIAL_CONDUCTOR)
                       ? fresnelConductor(cosTheta, double{m.conductorEta[c]}, double{m.conductorK[c]})
                       : schlick(double{m.baseColor[c]}, cosTheta);
    if (m.iridescence > 0)
        metal = glm::dvec3(
            probe(row.features).ask({drawQuery(m, directionAt(cosTheta), {0.5f, 0.3f, 0.6f})}).front().value);
    return glm::mix(r, metal, double{m.metallic});
}

glm::dvec3 HardLobeMirrors::transmittance(const LobeRow& row, double cosTheta) {
    const ProbeMaterial& m = row.material;
    const glm::dvec3 r = dielectric(row, cosTheta, etaOf(m));
    const double compressed = isSolid(m) ? etaOf(m) * etaOf(m) : 1;
    return glm::dvec3(m.baseColor) *
           ((1 - double{m.metallic}) * double{m.transmission} * (1 - std::max({r.x, r.y, r.z})) / compressed);
}

/// The chance that a weight implies: chance times weight is the light, in every channel.
double HardLobeMirrors::chanceOf(const Drawn& drawn, const glm::dvec3& light) {
    double chance = 0;
    for (int c = 0; c < 3; ++c) {
        if (light[c] < 1e-3) continue;
        const double same = light[c] / drawn.weight[c];
        if (chance == 0) chance = same;
        recordWorst("channels", std::abs(same / chance - 1));
        EXPECT_NEAR(same, chance, 1e-4 * chance);
    }
    return chance;
}

void HardLobeMirrors::expectNothingToEvaluate(const LobeRow& row, const glm::vec3& wo,
                                              const std::vector<glm::dvec3>& towards) {
    std::vector<BsdfQuery> queries;
    for (const glm::dvec3& wi : towards) queries.push_back(evalQuery(row.material, wo, glm::vec3(wi)));
    std::mt19937 random(18);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int i = 0; i < 40; ++i) {
        glm::vec3 wi = directionAt(1e-3 + 0.999 * uniform(random), 7 * uniform(random));
        if (i % 2 != 0) wi.z = -wi.z;
        queries.push_back(evalQuery(row.material, wo, wi));
    }
    for (const BsdfAnswer& a : probe(row.features).ask(queries)) {
        EXPECT_EQ(a.wi.w, 0) << row.name;
        EXPECT_EQ(glm::vec3(a.value), glm::vec3(0)) << row.name;
    }
}

void HardLobeMirrors::expectMirror(const LobeRow& row, double degrees) {
    std::ostringstream name;
    name << row.name << " at " << degrees;
    SCOPED_TRACE(name.str());
    const glm::vec3 wo = directionAt(std::cos(degrees * std::numbers::pi / 180), 0.4);
    const double cosTheta = double{wo.z}, eta = etaOf(row.material);
    const glm::dvec3 mirrored(-wo.x, -wo.y, wo.z);
    glm::dvec3 through = glm::dvec3(-wo);
    if (isSolid(row.material))
        through = {-double{wo.x} / eta, -double{wo.y} / eta, -refracted(cosTheta, eta)};

    std::mt19937 random(static_cast<uint32_t>(degrees * 10) + 18);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BsdfQuery> draws;
    for (int i = 0; i < kSamples; ++i)
        draws.push_back(drawQuery(row.material, wo, {uniform(random), uniform(random), uniform(random)}));
    Drawn reflected, passed;
    for (const BsdfAnswer& a : probe(row.features).ask(draws)) {
        if (a.value.w != 2) continue;
        Drawn& kind = a.wi.z > 0 ? reflected : passed;
        const glm::dvec3 weight(a.value), wi(a.wi);
        if (kind.count++ == 0) kind.weight = weight;
        ASSERT_EQ(weight, kind.weight) << "one weight";
        const double off = glm::length(wi - (a.wi.z > 0 ? mirrored : through));
        recordWorst("direction", off);
        ASSERT_LE(off, 1e-6);
    }
    const glm::dvec3 r = reflectance(row, cosTheta), t = transmittance(row, cosTheta);
    const double toReflect = chanceOf(reflected, r), toPass = chanceOf(passed, t);
    EXPECT_EQ(reflected.count > 0, std::max({r.x, r.y, r.z}) > 0);
    EXPECT_EQ(passed.count > 0, std::max({t.x, t.y, t.z}) > 0);
    const int others = kSamples - reflected.count - passed.count;
    const double remains = 1 - toReflect - toPass;
    std::vector<Cell> cells{{kSamples * toReflect, double(reflected.count)},
                            {kSamples * toPass, double(passed.count)}};
    if (remains < 1e-5) {
        EXPECT_GT(remains, -1e-5);
        EXPECT_EQ(others, 0);
        expectNothingToEvaluate(row, wo, {mirrored, through});
    } else {
        cells.push_back({kSamples * remains, double(others)});
    }
    compare(chiSquareOf(cells), name.str());
}

TEST_F(HardLobeMirrors, HardCase18_MirrorsAreDrawnAsOftenAsTheirLightSays) {
    std::vector<LobeRow> rows = facetLobes(0);
    // Over a rough base, and a diffuse one. What sheen leaves a mirror is from a table, not a closed form.
    for (const LobeRow& row : layeredLobes(0))
        if (row.material.sheenColor == glm::vec3(0)) rows.push_back(row);
    for (const LobeRow& row : rows)
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 85.0, 89.0, 89.9}) expectMirror(row, degrees);
}

}  // namespace
}  // namespace tilefarm
