// The lobes against what must hold whatever their parameters: energy, agreement of sampling with
// evaluation, reciprocity. Through the real shader code.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/shader/bsdf_probe_runner.h"
#include "tests/shader/device_fixture.h"
#include "worker/render/albedo_table.h"

namespace tilefarm {
namespace {

constexpr float kIor = 1.5f;

struct Lobe {
    glm::vec3 color{1};
    float metallic = 0, alpha = 0.25f, ior = kIor, transmission = 0, thin = 0, frontFace = 1;
};

glm::vec3 direction(double cosTheta, double phi = 0.3) {
    const double s = std::sqrt(1 - cosTheta * cosTheta);
    return {s * std::cos(phi), s * std::sin(phi), cosTheta};
}

BsdfQuery query(const Lobe& lobe, const glm::vec3& wo, const glm::vec3& other, float mode) {
    return {{wo, lobe.frontFace},
            {lobe.color, lobe.metallic},
            {lobe.alpha, lobe.ior, lobe.transmission, lobe.thin},
            {other, mode}};
}

class BsdfTest : public DeviceTest {
protected:
    struct Moments {
        double mean = 0, sigma = 0;  // of the red weight; sigma of the mean
        double transmitted = 0;
    };

    // Mean weight of samples with random numbers of their own: the directional albedo.
    Moments albedo(const Lobe& lobe, double cosTheta, int n = 40000) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> uniform(0, 1);
        std::vector<BsdfQuery> queries;
        for (int i = 0; i < n; ++i)
            queries.push_back(
                query(lobe, direction(cosTheta), {uniform(random), uniform(random), uniform(random)}, 0));
        Moments m;
        double squares = 0;
        for (const BsdfAnswer& a : probe.ask(queries)) {
            m.mean += a.value.x;
            squares += double{a.value.x} * a.value.x;
            if (a.wi.z < 0) m.transmitted += a.value.x;
        }
        m.mean /= n;
        m.transmitted /= n;
        m.sigma = std::sqrt(std::max(squares / n - m.mean * m.mean, 0.0) / n);
        return m;
    }

    BsdfProbe probe{device, kIor};
};

TEST_F(BsdfTest, WhiteLambertReturnsAllLight) {
    Lobe matte{.ior = 1};
    matte.alpha = 1;
    // With an index of 1 the table of 1.5 must not be asked: the interface is not there.
    BsdfProbe matteProbe(device, 1);
    std::vector<BsdfQuery> queries;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j)
            queries.push_back(query(matte, direction(0.6), {0.5f, (i + .5f) / 64, (j + .5f) / 64}, 0));
    double sum = 0;
    for (const BsdfAnswer& a : matteProbe.ask(queries)) sum += a.value.x;
    EXPECT_NEAR(sum / 4096, 1, 1e-3);
}

TEST_F(BsdfTest, WhitePlasticReturnsAllLightAtEveryAngleAndRoughness) {
    for (const double cosTheta : {0.05, 0.3, 0.7, 1.0})
        for (const float alpha : {0.0f, 0.01f, 0.1f, 0.4f, 1.0f}) {
            const Moments m = albedo({.alpha = alpha}, cosTheta);
            EXPECT_NEAR(m.mean, 1, 4 * m.sigma + 0.005) << "cos " << cosTheta << " alpha " << alpha;
        }
}

TEST_F(BsdfTest, WhiteMetalReturnsItsSingleScatteringAlbedo) {
    for (const double cosTheta : {0.1, 0.5, 0.9})
        for (const float alpha : {0.02f, 0.3f, 1.0f}) {
            const Moments m = albedo({.metallic = 1, .alpha = alpha}, cosTheta);
            // An index so large that everything is reflected gives E for F = 1.
            const double expected = reflectionAlbedo(cosTheta, alpha, 1e9);
            EXPECT_NEAR(m.mean, expected, 4 * m.sigma + 0.005) << "cos " << cosTheta << " alpha " << alpha;
            EXPECT_LE(m.mean, 1.005);
        }
}

TEST_F(BsdfTest, ClearGlassKeepsAllEnergyButWhatMaskingTakes) {
    for (const float frontFace : {1.f, 0.f})
        for (const float alpha : {0.f, 0.05f}) {
            for (const double cosTheta : {0.2, 0.6, 0.95}) {
                const Lobe glass{.alpha = alpha, .transmission = 1, .frontFace = frontFace};
                const double eta = frontFace != 0 ? kIor : 1 / kIor;
                const Moments m = albedo(glass, cosTheta);
                // Radiance is compressed by 1/eta² on its way through.
                const double energy = m.mean - m.transmitted + m.transmitted * eta * eta;
                // Single scattering: what microfacets shadow is lost, hardly more than a perfect mirror
                // loses. The 5e-3 are for refracted directions that turn back above the surface (2e-3 to 3e-3
                // measured).
                const double least = reflectionAlbedo(cosTheta, alpha, 1e9),
                             slack = 4 * m.sigma * eta * eta + 5e-3;
                EXPECT_GE(energy, least - slack)
                    << "front " << frontFace << " alpha " << alpha << " cos " << cosTheta;
                EXPECT_LE(energy, 1 + slack)
                    << "front " << frontFace << " alpha " << alpha << " cos " << cosTheta;
            }
        }
}

TEST_F(BsdfTest, ThinGlassSplitsLightByFresnel) {
    const Moments m = albedo({.alpha = 0, .transmission = 1, .thin = 1}, 1);
    EXPECT_NEAR(m.transmitted, 0.96, 4 * m.sigma + 1e-3);
    EXPECT_NEAR(m.mean, 1, 4 * m.sigma + 1e-3);
}

TEST_F(BsdfTest, SamplesCarryTheWeightAndPdfThatEvaluationGives) {
    const std::vector<Lobe> lobes{{.color = {.8f, .5f, .2f}},
                                  {.metallic = 1, .alpha = 0.05f},
                                  {.metallic = 0.5f, .alpha = 0.6f},
                                  {.alpha = 0.1f, .transmission = 1},
                                  {.alpha = 0.1f, .transmission = 1, .frontFace = 0},
                                  {.alpha = 0.2f, .transmission = 0.5f, .thin = 1}};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BsdfQuery> samples;
    for (const Lobe& lobe : lobes)
        for (int i = 0; i < 2000; ++i)
            samples.push_back(query(lobe, direction(0.05 + 0.95 * uniform(random)),
                                    {uniform(random), uniform(random), uniform(random)}, 0));
    const auto drawn = probe.ask(samples);
    std::vector<BsdfQuery> evaluations = samples;
    for (size_t i = 0; i < samples.size(); ++i) evaluations[i].other = glm::vec4(glm::vec3(drawn[i].wi), 1);
    const auto evaluated = probe.ask(evaluations);
    int compared = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
        if (drawn[i].value.w == 0) continue;
        ++compared;
        EXPECT_NEAR(evaluated[i].wi.w, drawn[i].wi.w, 1e-3 * drawn[i].wi.w);
        EXPECT_NEAR(evaluated[i].value.x, drawn[i].value.x * drawn[i].wi.w,
                    1e-3 * evaluated[i].value.x + 1e-6);
    }
    EXPECT_GT(compared, 10000);
}

TEST_F(BsdfTest, ReflectionIsReciprocal) {
    const std::vector<Lobe> lobes{{.color = {.8f, .5f, .2f}},
                                  {.metallic = 1, .alpha = 0.3f},
                                  {.metallic = 0.3f, .alpha = 0.7f},
                                  {.alpha = 0.3f, .transmission = 0.4f, .thin = 1}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.02, 1);
    std::vector<BsdfQuery> there, back;
    for (const Lobe& lobe : lobes)
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 a = direction(uniform(random), 6.28 * uniform(random)),
                            b = direction(uniform(random), 6.28 * uniform(random));
            there.push_back(query(lobe, a, b, 1));
            back.push_back(query(lobe, b, a, 1));
        }
    const auto f = probe.ask(there), g = probe.ask(back);
    for (size_t i = 0; i < f.size(); ++i) {
        const double forth = f[i].value.x / there[i].other.z, reverse = g[i].value.x / back[i].other.z;
        EXPECT_NEAR(forth, reverse, 1e-3 * std::max(forth, reverse) + 1e-6);
    }
}

// χ² of sampled directions against the pdf over a grid of cosθ and φ, integrated per cell by a fine grid.
TEST_F(BsdfTest, DirectionsFollowThePdf) {
    const std::vector<Lobe> lobes{{.color = glm::vec3(0.5f)},
                                  {.metallic = 1, .alpha = 0.3f},
                                  {.alpha = 0.3f, .transmission = 1},
                                  {.alpha = 0.4f, .transmission = 1, .frontFace = 0},
                                  {.alpha = 0.5f, .transmission = 1, .thin = 1}};
    constexpr int kZ = 10, kPhi = 10, kFine = 12, kSamples = 60000;
    for (size_t l = 0; l < lobes.size(); ++l) {
        const glm::vec3 wo = direction(0.6, 0);
        std::mt19937 random(11);
        std::uniform_real_distribution<float> uniform(0, 1);
        std::vector<BsdfQuery> samples, grid;
        for (int i = 0; i < kSamples; ++i)
            samples.push_back(query(lobes[l], wo, {uniform(random), uniform(random), uniform(random)}, 0));
        for (int z = 0; z < 2 * kZ * kFine; ++z)
            for (int p = 0; p < kPhi * kFine; ++p)
                grid.push_back(query(
                    lobes[l], wo,
                    direction(-1 + (z + .5) / (kZ * kFine), 2 * std::numbers::pi * (p + .5) / (kPhi * kFine)),
                    1));
        std::vector<double> expected(2 * kZ * kPhi), seen(2 * kZ * kPhi);
        const auto pdfs = probe.ask(grid);
        const double cell = 2 * std::numbers::pi / (kZ * kFine * kPhi * kFine);
        for (size_t i = 0; i < pdfs.size(); ++i)
            expected[(i / (kPhi * kFine)) / kFine * kPhi + (i % (kPhi * kFine)) / kFine] +=
                pdfs[i].wi.w * cell * kSamples;
        double total = 0;
        for (const BsdfAnswer& a : probe.ask(samples)) {
            if (a.value.w == 0) continue;
            const int z = std::min(int((a.wi.z + 1) * kZ), 2 * kZ - 1);
            double phi = std::atan2(a.wi.y, a.wi.x) / (2 * std::numbers::pi);
            if (phi < 0) phi += 1;
            ++seen[static_cast<size_t>(z * kPhi + std::min(int(phi * kPhi), kPhi - 1))];
            ++total;
        }
        double chi2 = 0;
        int cells = 0;
        for (size_t i = 0; i < seen.size(); ++i) {
            if (expected[i] < 20) continue;
            // The grid integrates a peaked pdf to about half a percent; that is allowed on top of the
            // counting noise.
            const double slack = 0.01 * expected[i];
            chi2 += std::pow(seen[i] - expected[i], 2) / (expected[i] + slack * slack);
            ++cells;
        }
        ASSERT_GT(cells, 20) << "lobe " << l;
        EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells)) << "lobe " << l << ", " << cells << " cells";
    }
}

TEST_F(BsdfTest, GrazingAndDegenerateDirectionsStayFinite) {
    std::vector<BsdfQuery> queries;
    for (const float cosTheta : {1e-3f, 1e-5f, 1e-7f, 1.f})
        for (const float alpha : {0.f, 1e-3f, 0.1f, 1.f})
            for (const float transmission : {0.f, 1.f})
                for (const float u : {0.f, 0.3f, 0.99999994f})
                    queries.push_back(query({.alpha = alpha, .transmission = transmission},
                                            direction(cosTheta), {u, u, 1 - u}, 0));
    for (const BsdfAnswer& a : probe.ask(queries)) {
        EXPECT_TRUE(std::isfinite(a.value.x) && std::isfinite(a.wi.w));
        EXPECT_GE(a.wi.w, 0);
    }
}

}  // namespace
}  // namespace tilefarm
