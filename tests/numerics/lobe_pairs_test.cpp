// Cases 19 and 22 over every lobe (lobe_table.h): what is drawn is what is evaluated, and light goes back the
// way it came.
#include <cmath>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/lobe_table.h"
#include "tests/numerics/statistics.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr double kTolerance = 1e-4;
/// Values below are exempt, being next to the end of fp32, 1.2e-38: the tails of Beckmann and Phong.
constexpr double kFloor = 1e-30;

constexpr float kAlphas[]{1e-3f, 0.01f, 0.05f, 0.1f, 0.3f, 0.6f, 1};

using Rows = std::vector<LobeRow>;

void append(Rows& rows, const Rows& more) {
    rows.insert(rows.end(), more.begin(), more.end());
}

/// Every lobe that is reciprocal, at all roughnesses and stretches.
Rows allRows() {
    Rows rows = diffuseLobes();
    for (const float alpha : kAlphas) {
        for (const float stretch : kStretches) append(rows, facetLobes(alpha, stretch));
        append(rows, hazeLobes(alpha));
    }
    return rows;
}
/// Every one, at a few.
Rows fewRows() {
    Rows rows = diffuseLobes();
    for (const float alpha : {1e-3f, 0.05f, 0.6f}) {
        append(rows, basicLobes(alpha));
        append(rows, plainLobes(alpha, 25));
        append(rows, hazeLobes(alpha));
    }
    return rows;
}

/// Directions with cosines from 1e-3 to 1, every fifth by its logarithm.
class Directions {
public:
    explicit Directions(uint32_t seed) : random_(seed) {}
    float number() { return uniform_(random_); }
    glm::vec3 next() {
        const float code = number(), at = number();
        return directionAt(code < 0.2f ? std::pow(10.f, -3 * at) : 1e-3f + 0.999f * at, 2 * pi * number());
    }
    BsdfQuery draw(const LobeRow& row) {
        return drawQuery(row.material, next(), {number(), number(), number()});
    }

private:
    std::mt19937 random_;
    std::uniform_real_distribution<float> uniform_{0, 1};
};

class HardLobePairs : public LobeTest {
protected:
    /// Samples that are no delta, and where they go.
    std::vector<BsdfQuery> evaluationsOf(const LobeRow& row, const std::vector<BsdfQuery>& draws,
                                         const std::vector<BsdfAnswer>& drawn);
    void expectSamplesToCarryWhatIsEvaluated(const LobeRow& row, int count);
    /// The largest of |f(i, o) − f(o, i)| over the larger of both; across a refracting interface f is divided
    /// by η².
    double mostIrreciprocal(const LobeRow& row, int count);
};

std::vector<BsdfQuery> HardLobePairs::evaluationsOf(const LobeRow& row, const std::vector<BsdfQuery>& draws,
                                                    const std::vector<BsdfAnswer>& drawn) {
    std::vector<BsdfQuery> evaluations;
    for (size_t i = 0; i < draws.size(); ++i)
        if (drawn[i].value.w == 1)
            evaluations.push_back(evalQuery(row.material, glm::vec3(draws[i].wo), glm::vec3(drawn[i].wi)));
    return evaluations;
}

// ---- 19

double relative(double a, double b) {
    return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

void HardLobePairs::expectSamplesToCarryWhatIsEvaluated(const LobeRow& row, int count) {
    Directions directions(19);
    std::vector<BsdfQuery> draws;
    for (int i = 0; i < count; ++i) draws.push_back(directions.draw(row));
    const auto drawn = probe(row.features).ask(draws);
    const auto evaluated = probe(row.features).ask(evaluationsOf(row, draws, drawn));
    size_t next = 0;
    for (const BsdfAnswer& sample : drawn) {
        if (sample.value.w != 1) continue;
        const BsdfAnswer& evaluation = evaluated[next++];
        const double pdf = relative(double{sample.wi.w}, double{evaluation.wi.w});
        double weight = 0;
        for (int c = 0; c < 3; ++c) {
            const double f = double{evaluation.value[c]};
            if (f > kFloor)
                weight = std::max(weight, relative(double{sample.value[c]} * double{sample.wi.w}, f));
        }
        recordWorst("pdf", pdf);
        recordWorst("weight", weight);
        ASSERT_LE(std::max(pdf, weight), kTolerance) << row.name << " alpha " << row.material.alpha;
    }
    EXPECT_GT(next, size_t(count) / 20) << row.name << " alpha " << row.material.alpha;
}

TEST_F(HardLobePairs, HardCase19_SamplesCarryWhatIsEvaluated) {
    for (const LobeRow& row : fewRows()) expectSamplesToCarryWhatIsEvaluated(row, 300);
    for (const LobeRow& row : layeredLobes(0.1f)) expectSamplesToCarryWhatIsEvaluated(row, 300);
}
TEST_F(HardLobePairs, FullHardCase19_SamplesCarryWhatIsEvaluated) {
    for (const LobeRow& row : allRows()) expectSamplesToCarryWhatIsEvaluated(row, 4000);
    for (const float alpha : kAlphas)
        for (const LobeRow& row : layeredLobes(alpha)) expectSamplesToCarryWhatIsEvaluated(row, 4000);
}

// ---- 22

double etaOf(const ProbeMaterial& m) {
    const bool thin = (static_cast<uint32_t>(m.flags) & gpu::MATERIAL_THIN) != 0;
    if (thin || m.transmission == 0) return 1;
    return m.frontFace != 0 ? m.ior : 1 / double{m.ior};
}

/// The pair the other way round. Seen from the other side the frame's normal points the other way.
BsdfQuery reversed(const ProbeMaterial& material, const BsdfQuery& query) {
    const bool across = query.other.z < 0;
    ProbeMaterial seen = material;
    if (across && etaOf(material) != 1) seen.frontFace = 1 - seen.frontFace;
    const glm::vec3 flip(1, 1, across ? -1 : 1);
    return evalQuery(seen, glm::vec3(query.other) * flip, glm::vec3(query.wo) * flip);
}

double HardLobePairs::mostIrreciprocal(const LobeRow& row, int count) {
    Directions directions(22);
    std::vector<BsdfQuery> draws, there, back;
    for (int i = 0; i < count; ++i) {
        draws.push_back(directions.draw(row));
        const glm::vec3 wo = directions.next(), wi = directions.next();
        there.push_back(evalQuery(row.material, wo, {wi.x, wi.y, i % 2 == 0 ? wi.z : -wi.z}));
    }
    // Where the lobe is.
    for (const BsdfQuery& q : evaluationsOf(row, draws, probe(row.features).ask(draws)))
        if (std::abs(q.other.z) > 1e-3f) there.push_back(q);
    for (const BsdfQuery& q : there) back.push_back(reversed(row.material, q));
    const auto f = probe(row.features).ask(there), g = probe(row.features).ask(back);
    const double eta = etaOf(row.material);
    double worst = 0;
    int lit = 0;
    for (size_t i = 0; i < f.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double scale = there[i].other.z < 0 ? eta * eta : 1;
            const double forth = scale * double{f[i].value[c]} / std::abs(double{there[i].other.z}),
                         reverse = double{g[i].value[c]} / std::abs(double{back[i].other.z});
            if (std::max(forth, reverse) < kFloor) continue;
            ++lit;
            worst = std::max(worst, relative(forth, reverse));
        }
    EXPECT_GT(lit, count / 2) << row.name;
    return worst;
}

TEST_F(HardLobePairs, HardCase22_ReciprocityBetweenAnyDirections) {
    for (const LobeRow& row : fewRows()) {
        const double off = mostIrreciprocal(row, 300);
        recordWorst("relative", off);
        EXPECT_LE(off, kTolerance) << row.name << " alpha " << row.material.alpha;
    }
}
TEST_F(HardLobePairs, FullHardCase22_ReciprocityBetweenAnyDirections) {
    for (const LobeRow& row : allRows()) {
        const double off = mostIrreciprocal(row, 10'000);
        recordWorst("relative", off);
        EXPECT_LE(off, kTolerance) << row.name << " alpha " << row.material.alpha << " along "
                                   << row.material.alphaT;
    }
}
/// Exceptions, as their sources have them: clearcoat and sheen scale what lies below by what they take of one
/// direction alone (KHR_materials_clearcoat, KHR_materials_sheen), and a coat with a normal of its own is
/// weighed by the cosine with the base's, as every shading normal is.
TEST_F(HardLobePairs, HardCase22_TheExceptionsAreThoseListed) {
    Rows rows = layeredLobes(0.1f);
    rows.pop_back();  // the leaf has no layer above
    LobeRow tilted = rows.front();
    tilted.name = "tilted coat";
    tilted.material.baseColor = glm::vec3(0);
    tilted.material.ior = 1;
    tilted.material.clearcoatNormal = directionAt(0.96, 1.1);
    rows.push_back(tilted);
    for (const LobeRow& row : rows)
        EXPECT_GT(mostIrreciprocal(row, 300), kTolerance) << row.name << " is no exception any more";
    const double leaf = mostIrreciprocal(layeredLobes(0.1f).back(), 300);
    EXPECT_LE(leaf, kTolerance) << "a base below facets alone";
}

}  // namespace
}  // namespace tilefarm
