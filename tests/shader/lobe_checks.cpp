#include "tests/shader/lobe_checks.h"

#include <cmath>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"

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

glm::dvec3 mirrored(const glm::dvec3& w) {
    return {w.x, w.y, -w.z};
}

/// A part of the sphere of directions on the unit square.
struct Chart {
    enum class Kind { above, below, reflected, refracted, thin } kind;
    glm::dvec3 wo;
    double alphaX = 1, alphaY = 1, eta = 1;

    bool map(double s, double t, glm::dvec3& wi) const {
        const double phi = 2 * pi * t;
        if (kind == Kind::above || kind == Kind::below) {
            const double r = std::sqrt(1 - s * s);
            wi = {r * std::cos(phi), r * std::sin(phi), kind == Kind::above ? s : -s};
            return true;
        }
        const double x = s / (1 - s);
        const glm::dvec3 h =
            glm::normalize(glm::dvec3(alphaX * x * std::cos(phi), alphaY * x * std::sin(phi), 1));
        const double cosine = glm::dot(wo, h);
        if (cosine <= 0) return false;
        if (kind == Kind::refracted) {
            const double sinSquared = (1 - cosine * cosine) / (eta * eta);
            if (sinSquared >= 1) return false;
            wi = -wo / eta + (cosine / eta - std::sqrt(1 - sinSquared)) * h;
            return wi.z < 0;
        }
        wi = 2 * cosine * h - wo;
        if (kind == Kind::thin) wi.z = -wi.z;
        return kind == Kind::thin ? wi.z < 0 : wi.z > 0;
    }

    bool unmap(const glm::dvec3& wi, double& s, double& t) const {
        const bool up = wi.z > 0;
        if (up != (kind == Kind::above || kind == Kind::reflected)) return false;
        glm::dvec3 axis = wi;
        s = std::abs(wi.z);
        if (kind != Kind::above && kind != Kind::below) {
            glm::dvec3 h = kind == Kind::refracted ? wo + eta * wi : wo + (up ? wi : mirrored(wi));
            if (h.z < 0) h = -h;
            if (!(h.z > 0)) return false;
            axis = {h.x / (h.z * alphaX), h.y / (h.z * alphaY), 0};
            const double x = std::hypot(axis.x, axis.y);
            s = x / (1 + x);
        }
        t = std::atan2(axis.y, axis.x) / (2 * pi);
        if (t < 0) t += 1;
        // Broad lobes also reach directions to which no half vector leads.
        glm::dvec3 same;
        return map(s, t, same) && glm::dot(same, wi) > 0.9999;
    }

    /// Solid angle per unit of the square.
    double jacobian(double s, double t) const {
        constexpr double d = 1e-5;
        glm::dvec3 s0, s1, t0, t1;
        if (!map(s - d, t, s0) || !map(s + d, t, s1) || !map(s, t - d, t0) || !map(s, t + d, t1)) return 0;
        return glm::length(glm::cross(s1 - s0, t1 - t0)) / (4 * d * d);
    }
};

std::vector<Chart> chartsOf(const ProbeMaterial& m, const glm::dvec3& wo, bool facets) {
    using Kind = Chart::Kind;
    if (!facets) return {{Kind::above, wo}, {Kind::below, wo}};
    const double x = m.alphaT < 0 ? m.alpha : m.alphaT, y = m.alpha;
    return {{Kind::reflected, wo, x, y}, {isThin(m) ? Kind::thin : Kind::refracted, wo, x, y, etaOf(m)}};
}

constexpr int kGrid = 12, kFine = 10;

std::vector<BsdfQuery> randomDraws(const LobeRow& row, const glm::vec3& wo, int n, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BsdfQuery> queries;
    for (int i = 0; i < n; ++i)
        queries.push_back(drawQuery(row.material, wo, {uniform(random), uniform(random), uniform(random)}));
    return queries;
}

/// What χ² with `cells` degrees of freedom exceeds with probability 1e-4 (Wilson, Hilferty 1931).
double chiSquareLimit(int cells) {
    const double k = 2.0 / (9.0 * cells), z = 3.719;
    return cells * std::pow(1 - k + z * std::sqrt(k), 3);
}

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
        EXPECT_NEAR(evaluated[i].wi.w, drawn[i].wi.w, 1e-3 * drawn[i].wi.w) << row.name;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(evaluated[i].value[c], drawn[i].value[c] * drawn[i].wi.w,
                        1e-3 * evaluated[i].value[c] + 1e-6)
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
            // Far out in a lobe's tail the half vector's rounding shows.
            EXPECT_NEAR(forth, reverse, 1e-3 * std::max(forth, reverse) + 5e-6)
                << row.name << ", cos " << there[i].wo.z << " and " << there[i].other.z;
        }
}

void LobeTest::expectChiSquare(const LobeRow& row, double cosTheta, bool facets) {
    constexpr int kSamples = 40000;
    const glm::vec3 wo = directionAt(cosTheta, 0.4);
    const std::vector<Chart> charts = chartsOf(row.material, glm::dvec3(wo), facets);
    constexpr size_t kCells = kGrid * kGrid;
    std::vector<double> expected(kCells * charts.size()), seen(kCells * charts.size()), jacobians;
    std::vector<size_t> cells;
    std::vector<BsdfQuery> grid;
    for (size_t chart = 0; chart < charts.size(); ++chart)
        for (int i = 0; i < kGrid * kFine; ++i)
            for (int j = 0; j < kGrid * kFine; ++j) {
                const double s = (i + .5) / (kGrid * kFine), t = (j + .5) / (kGrid * kFine);
                glm::dvec3 wi;
                if (!charts[chart].map(s, t, wi)) continue;
                grid.push_back(evalQuery(row.material, wo, glm::vec3(wi)));
                jacobians.push_back(charts[chart].jacobian(s, t));
                cells.push_back(chart * kCells + static_cast<size_t>(i / kFine * kGrid + j / kFine));
            }
    const auto pdfs = probe(row.features).ask(grid);
    constexpr double kCellArea = 1.0 / (kGrid * kFine * kGrid * kFine);
    for (size_t i = 0; i < pdfs.size(); ++i)
        expected[cells[i]] += pdfs[i].wi.w * jacobians[i] * kCellArea * kSamples;
    double elsewhere = 0;
    for (const BsdfAnswer& a : probe(row.features).ask(randomDraws(row, wo, kSamples, 11))) {
        bool found = false;
        for (size_t chart = 0; chart < charts.size() && !found && a.value.w == 1; ++chart) {
            double s, t;
            found = charts[chart].unmap(glm::dvec3(a.wi), s, t);
            if (found)
                ++seen[chart * kCells + static_cast<size_t>(std::min(int(s * kGrid), kGrid - 1) * kGrid +
                                                            std::min(int(t * kGrid), kGrid - 1))];
        }
        if (!found) ++elsewhere;
    }
    double chi2 = 0, inSmallCells = 0, seenInSmallCells = 0, total = 0;
    int freedom = 0;
    const auto addCell = [&](double want, double got) {
        // The grid integrates a peaked pdf to about half a percent; that is allowed on top of the noise.
        chi2 += std::pow(got - want, 2) / (want + std::pow(0.01 * want, 2));
        ++freedom;
    };
    for (size_t i = 0; i < seen.size(); ++i) {
        total += expected[i];
        if (expected[i] < 20) {
            inSmallCells += expected[i];
            seenInSmallCells += seen[i];
        } else {
            addCell(expected[i], seen[i]);
        }
    }
    EXPECT_GT(freedom, 8) << row.name;
    EXPECT_LT(total, kSamples * 1.01) << row.name << ": the pdf integrates to more than 1";
    // Cells on the border of what the chart reaches are integrated badly: they count as one.
    EXPECT_NEAR(seenInSmallCells + elsewhere, inSmallCells + std::max(kSamples - total, 0.0),
                5 * std::sqrt(inSmallCells + std::max(kSamples - total, 0.0) + 1) + 0.01 * kSamples)
        << row.name << ", cos " << cosTheta << ": rejected samples";
    EXPECT_LT(chi2, chiSquareLimit(freedom))
        << row.name << ", cos " << cosTheta << ", " << freedom << " cells";
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
