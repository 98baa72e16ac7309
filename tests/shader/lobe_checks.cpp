#include "tests/shader/lobe_checks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "shaders/gpu_types.h"
#include "tests/shader/lobe_histogram.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

bool isThin(const ProbeMaterial& m) {
    return (static_cast<uint32_t>(m.flags) & gpu::MATERIAL_THIN) != 0;
}

/// Index of the far side over that of wo's side, for what passes the interface.
double etaOf(const ProbeMaterial& m) {
    if (isThin(m) || m.transmission == 0) return 1;
    return m.frontFace != 0 ? m.ior : 1 / double{m.ior};
}

/// What tails may be off by, near the end of fp32 at 1.2e-38.
constexpr double kTail = 1e-30;

}  // namespace

glm::vec3 directionAt(double cosTheta, double phi) {
    const double s = std::sqrt(std::max(0.0, 1 - cosTheta * cosTheta));
    return {s * std::cos(phi), s * std::sin(phi), cosTheta};
}

BsdfProbe& LobeTest::probe(uint64_t features) {
    std::unique_ptr<BsdfProbe>& found = probes_[features];
    if (!found) found = std::make_unique<BsdfProbe>(device, features);
    return *found;
}

LobeTest::Moments LobeTest::albedo(const LobeRow& row, double cosTheta, int n, double phi) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    const int side = static_cast<int>(std::sqrt(n));
    std::vector<BsdfQuery> queries;
    for (int i = 0; i < n; ++i) {
        const float x = static_cast<float>(i % side), y = static_cast<float>(i / side % side);
        queries.push_back(drawQuery(
            row.material, directionAt(cosTheta, phi),
            {uniform(random), (x + uniform(random)) / float(side), (y + uniform(random)) / float(side)}));
    }
    Moments m;
    double squares = 0, energySquares = 0;
    const double etaSquared = etaOf(row.material) * etaOf(row.material);
    for (const BsdfAnswer& a : probe(row.features).ask(queries)) {
        const glm::dvec3 weight(a.value), energy = a.wi.z < 0 ? weight * etaSquared : weight;
        m.mean += weight;
        squares += weight.x * weight.x;
        if (a.wi.z < 0) m.transmitted += weight;
        m.energy += energy;
        energySquares += energy.x * energy.x;
    }
    m.mean /= n;
    m.transmitted /= n;
    m.energy /= n;
    m.sigma = std::sqrt(std::max(squares / n - m.mean.x * m.mean.x, 0.0) / n);
    m.energySigma = std::sqrt(std::max(energySquares / n - m.energy.x * m.energy.x, 0.0) / n);
    return m;
}

void LobeTest::expectEnergy(const LobeRow& row, double most, double least) {
    for (const double cosTheta : {0.02, 0.1, 0.4, 0.7, 1.0}) {
        const Moments m = albedo(row, cosTheta);
        for (int c = 0; c < 3; ++c) {
            EXPECT_LE(m.energy[c], most + 4 * m.energySigma) << row.name << " at cos " << cosTheta;
            EXPECT_GE(m.energy[c], least - 4 * m.energySigma) << row.name << " at cos " << cosTheta;
        }
    }
}

void LobeTest::expectAgreement(const LobeRow& row) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BsdfQuery> samples, evaluations;
    for (int i = 0; i < 1500; ++i)
        samples.push_back(drawQuery(row.material,
                                    directionAt(0.05 + 0.95 * uniform(random), 7 * uniform(random)),
                                    {uniform(random), uniform(random), uniform(random)}));
    const auto drawn = probe(row.features).ask(samples);
    for (size_t i = 0; i < samples.size(); ++i)
        evaluations.push_back(evalQuery(row.material, glm::vec3(samples[i].wo), glm::vec3(drawn[i].wi)));
    const auto evaluated = probe(row.features).ask(evaluations);
    int compared = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
        if (drawn[i].value.w != 1) continue;
        ++compared;
        EXPECT_NEAR(evaluated[i].wi.w, drawn[i].wi.w, 1e-4 * drawn[i].wi.w) << row.name;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(evaluated[i].value[c], drawn[i].value[c] * drawn[i].wi.w,
                        1e-4 * evaluated[i].value[c] + kTail)
                << row.name;
    }
    EXPECT_GT(compared, 500) << row.name;
}

void LobeTest::expectReciprocity(const LobeRow& row) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.02, 1);
    const double eta = etaOf(row.material);
    ProbeMaterial otherSide = row.material;
    otherSide.frontFace =
        otherSide.frontFace != 0 || eta == 1 ? (eta == 1 ? row.material.frontFace : 0.f) : 1.f;
    std::vector<BsdfQuery> there, back;
    std::vector<double> scale;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 a = directionAt(uniform(random), 2 * pi * uniform(random));
        glm::vec3 b = directionAt(uniform(random), 2 * pi * uniform(random));
        const bool across = i % 2 != 0;
        // Seen from the other side the frame's normal points the other way.
        if (across) {
            there.push_back(evalQuery(row.material, a, {b.x, b.y, -b.z}));
            back.push_back(evalQuery(otherSide, b, {a.x, a.y, -a.z}));
        } else {
            there.push_back(evalQuery(row.material, a, b));
            back.push_back(evalQuery(row.material, b, a));
        }
        scale.push_back(across ? eta * eta : 1);
    }
    const auto f = probe(row.features).ask(there), g = probe(row.features).ask(back);
    for (size_t i = 0; i < f.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double forth = scale[i] * f[i].value[c] / std::abs(double{there[i].other.z}),
                         reverse = g[i].value[c] / std::abs(double{back[i].other.z});
            EXPECT_NEAR(forth, reverse, 1e-4 * std::max(forth, reverse) + kTail)
                << row.name << ", cos " << there[i].wo.z << " and " << there[i].other.z;
        }
}

void LobeTest::expectChiSquare(const LobeRow& row, double cosTheta, double phi) {
    constexpr int kSamples = 40000;
    double overshoot;
    const ChiSquare found =
        lobeHistogram(probe(row.features), row.material, directionAt(cosTheta, phi), kSamples,
                      static_cast<uint32_t>(comparisons_.size()) + 11, overshoot);
    std::ostringstream name;
    name << row.name << " alpha " << row.material.alpha << " cos " << cosTheta << ": chi2 " << found.statistic
         << " of " << found.freedom;
    EXPECT_LT(overshoot, 2e-3) << name.str() << ": the pdf integrates to more than 1";
    compare(found, name.str());
}

void LobeTest::compare(const ChiSquare& found, const std::string& name) {
    if (found.freedom > 0) comparisons_.emplace_back(found.p, name);
}

void LobeTest::TearDown() {
    if (!comparisons_.empty()) {
        const auto& [p, name] = *std::min_element(comparisons_.begin(), comparisons_.end());
        const double corrected = sidak(p, std::max(familySize, comparisons_.size()));
        RecordProperty("p", std::to_string(corrected));
        RecordProperty("comparisons", static_cast<int>(comparisons_.size()));
        EXPECT_GT(corrected, 0.01) << name << ", p " << p;
    }
    DeviceTest::TearDown();
}

void LobeTest::expectFinite(const LobeRow& row) {
    std::vector<BsdfQuery> queries;
    for (const float cosTheta : {1e-3f, 1e-5f, 1e-7f, 1.f})
        for (const float u : {0.f, 0.3f, 0.7f, 0.99999994f})
            for (const float v : {0.f, 0.5f, 0.99999994f})
                queries.push_back(drawQuery(row.material, directionAt(cosTheta), {u, v, 1 - v}));
    for (const float cosTheta : {1e-3f, 1e-7f, 0.5f})
        for (const float other : {1e-7f, 1e-3f, 1.f})
            for (const float side : {1.f, -1.f}) {
                glm::vec3 wi = directionAt(other, 3.4);
                wi.z *= side;
                queries.push_back(evalQuery(row.material, directionAt(cosTheta), wi));
            }
    for (const BsdfAnswer& a : probe(row.features).ask(queries)) {
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(a.value[c]) && a.value[c] >= 0) << row.name;
        EXPECT_TRUE(std::isfinite(a.wi.w) && a.wi.w >= 0) << row.name;
    }
}

void LobeTest::expectSoundLobe(const LobeRow& row, bool reciprocal) {
    expectEnergy(row);
    expectFinite(row);
    if (row.material.alpha >= static_cast<float>(ALPHA_DELTA)) expectAgreement(row);
    if (reciprocal) expectReciprocity(row);
}

}  // namespace tilefarm
