// Properties of any material from any direction, through the shaders' own BSDF code. A case is a list of
// materials that share a dispatch; shrinking leaves one, as plain as still fails.
#include <cmath>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/property/furnace.h"
#include "tests/property/holds.h"
#include "tests/shader/device_fixture.h"

namespace tilefarm {
namespace {

using std::numbers::pi;
using Materials = std::vector<SeenMaterial>;

/// Beyond it, a deviation is none of chance: two-sided 5e-9, for up to a million comparisons.
constexpr double kLimit = 5.85;

struct Size {
    int cases, materials, draws;
    Variety variety;
    FurnaceEffort furnace;
};
const Size kQuick{4, 120, 512, Variety::few, {.first = 512, .last = 1u << 16}};
const Size kFull{20, 600, 2048, Variety::many, {.first = 1024, .last = 1u << 20}};

Materials anyMaterials(const Size& size) {
    return *rc::gen::resize(size.materials, rc::gen::container<Materials>(anyMaterial(size.variety)));
}

std::string named(const SeenMaterial& seen, const std::string& what) {
    std::ostringstream text;
    text << what << ": " << seen << "\n";
    return text.str();
}

glm::vec3 direction(double cosTheta, double phi) {
    const double r = std::sqrt((1 - cosTheta) * (1 + cosTheta));
    return {r * std::cos(phi), r * std::sin(phi), cosTheta};
}

class AnyMaterial : public DeviceTest {
protected:
    AnyMaterial() : probe(device, everyLobe() | gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION)) {}

    std::vector<BsdfAnswer> draw(const Materials& materials, int draws, uint32_t seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> u(0, 1);
        std::vector<BsdfQuery> queries;
        for (const SeenMaterial& seen : materials)
            for (int i = 0; i < draws; ++i) {
                const float x = u(random), y = u(random), z = u(random);
                queries.push_back(drawQuery(seen.material, seen.wo, {x, y, z}));
            }
        return probe.ask(std::move(queries));
    }

    std::string keepsEnergy(const Materials& materials, const FurnaceEffort& effort) {
        std::string faults;
        const auto furnaces = furnace(probe, materials, effort);
        for (size_t i = 0; i < materials.size(); ++i) {
            const Furnace& f = furnaces[i];
            if (f.unsound > 0)
                faults += named(materials[i], std::to_string(f.unsound) + " samples not finite");
            if (f.tooMuch && keepsEnergyTo1005(materials[i].material))
                faults += named(materials[i],
                                "energy " + std::to_string(std::max({f.energy.x, f.energy.y, f.energy.z})));
        }
        return faults;
    }

    std::string isFinite(const Materials& materials);
    std::string samplesFollowThePdf(const Materials& materials, int draws);
    std::string samplesAgreeWithEvaluation(const Materials& materials);
    std::string isReciprocal(const Materials& materials);
    void expectSoundMaterials(const Size& size);

    BsdfProbe probe;
};

/// Evaluation towards directions on both sides, the horizon and wo's mirror image among them.
std::string AnyMaterial::isFinite(const Materials& materials) {
    std::vector<BsdfQuery> queries;
    std::vector<size_t> of;
    for (size_t i = 0; i < materials.size(); ++i) {
        const glm::vec3 wo = materials[i].wo;
        std::vector<glm::vec3> others{{-wo.x, -wo.y, wo.z}, wo, -wo};
        for (const double cosTheta : {1e-7, 1e-4, 0.02, 0.5, 1.0})
            others.push_back(direction(cosTheta, 0.7 * double(i)));
        for (glm::vec3 wi : others)
            for (const float side : {1.f, -1.f}) {
                queries.push_back(evalQuery(materials[i].material, wo, {wi.x, wi.y, side * wi.z}));
                of.push_back(i);
            }
    }
    std::string faults;
    const auto answers = probe.ask(queries);
    for (size_t i = 0; i < answers.size(); ++i) {
        const BsdfAnswer& a = answers[i];
        bool sound = std::isfinite(a.wi.w) && a.wi.w >= 0;
        for (int c = 0; c < 3; ++c) sound = sound && std::isfinite(a.value[c]) && a.value[c] >= 0;
        std::ostringstream what;
        what << "towards " << queries[i].other.x << " " << queries[i].other.y << " " << queries[i].other.z
             << " f " << a.value.x << " " << a.value.y << " " << a.value.z << " pdf " << a.wi.w;
        if (!sound) faults += named(materials[of[i]], what.str());
    }
    return faults;
}

/// Every direction drawn is one that evaluation knows, with the same pdf and value.
std::string AnyMaterial::samplesAgreeWithEvaluation(const Materials& materials) {
    constexpr int kDraws = 16;
    const auto drawn = draw(materials, kDraws, 19);
    std::vector<BsdfQuery> queries;
    for (size_t i = 0; i < drawn.size(); ++i)
        queries.push_back(
            evalQuery(materials[i / kDraws].material, materials[i / kDraws].wo, glm::vec3(drawn[i].wi)));
    const auto evaluated = probe.ask(std::move(queries));
    std::string faults;
    for (size_t i = 0; i < drawn.size(); ++i) {
        if (drawn[i].value.w != 1) continue;
        const double pdf = drawn[i].wi.w;
        double off = std::abs(evaluated[i].wi.w - pdf) / pdf;
        for (int c = 0; c < 3; ++c) {
            const double f = drawn[i].value[c] * pdf;
            off = std::max(off, std::abs(evaluated[i].value[c] - f) / (f + 1e-6 * pdf));
        }
        if (!(off <= 1e-3))
            faults += named(materials[i / kDraws], "weight or pdf off by " + std::to_string(off));
    }
    return faults;
}

/// The same material somewhat rougher.
SeenMaterial rougher(SeenMaterial seen) {
    ProbeMaterial& m = seen.material;
    const auto more = [](float alpha) { return std::min(1.5f * alpha + 0.01f, 1.0f); };
    m.alpha = more(m.alpha);
    if (m.alphaT >= 0) m.alphaT = more(m.alphaT);
    m.clearcoatAlpha = more(m.clearcoatAlpha);
    return seen;
}

/// Draws of p and of q, densities of two materials: E_p[q / (p + q)] = ∫ p q / (p + q) = E_q[p / (p + q)].
/// Both means are of numbers between 0 and 1, so that few draws tell. A pdf that is not the one drawn by
/// shows in one of them.
std::string AnyMaterial::samplesFollowThePdf(const Materials& materials, int draws) {
    Materials others;
    for (const SeenMaterial& seen : materials) others.push_back(rougher(seen));
    const Materials* sides[]{&materials, &others};
    std::vector<double> sum(materials.size()), variance(materials.size());
    for (const int side : {0, 1}) {
        const auto drawn = draw(*sides[side], draws, 18 + static_cast<uint32_t>(side));
        std::vector<BsdfQuery> queries;
        for (size_t i = 0; i < drawn.size(); ++i) {
            const SeenMaterial& other = (*sides[1 - side])[i / static_cast<size_t>(draws)];
            queries.push_back(evalQuery(other.material, other.wo, glm::vec3(drawn[i].wi)));
        }
        const auto evaluated = probe.ask(std::move(queries));
        for (size_t m = 0; m < materials.size(); ++m) {
            double mean = 0, square = 0;
            for (int k = 0; k < draws; ++k) {
                const size_t i = m * static_cast<size_t>(draws) + static_cast<size_t>(k);
                const double own = drawn[i].wi.w, theirs = evaluated[i].wi.w;
                const double share = drawn[i].value.w == 1 ? theirs / (own + theirs) : 0;
                mean += share / draws;
                square += share * share / draws;
            }
            sum[m] += side == 0 ? mean : -mean;
            variance[m] += std::max(square - mean * mean, 0.0) / draws;
        }
    }
    std::string faults;
    for (size_t m = 0; m < materials.size(); ++m) {
        // The second term is for means of few draws that are not 0 (Bernstein's bound).
        const double limit = kLimit * std::sqrt(variance[m]) + kLimit * kLimit / draws;
        std::ostringstream what;
        what << "draws of it and of a rougher one disagree by " << sum[m] << ", limit " << limit;
        if (!(std::abs(sum[m]) <= limit)) faults += named(materials[m], what.str());
    }
    return faults;
}

/// What coat and sheen keep from the layers below depends on one direction alone, as their extensions have
/// it.
bool isReciprocalByItsModel(const ProbeMaterial& m) {
    return m.clearcoat == 0 && m.sheenColor == glm::vec3(0) && m.disneySheen == 0;
}

/// From inside, an index n refracts where 1 − cosθ is below 1 / 2n², of which a float near 1 keeps its 24
/// bits less those of n²: at 1000, three.
bool resolvesRefraction(const ProbeMaterial& m) {
    return m.ior <= 100;
}

/// f(wo, wi) = f(wi, wo) for directions drawn and any others; what refracts times eta², what passes the
/// diffuse base not.
std::string AnyMaterial::isReciprocal(const Materials& all) {
    constexpr int kDraws = 8;
    Materials materials;
    for (const SeenMaterial& seen : all)
        if (isReciprocalByItsModel(seen.material)) materials.push_back(seen);
    for (size_t i = 0; i < materials.size(); ++i)
        if (materials[i].wo.z < 0.02f) materials[i].wo = direction(0.02 + 0.1 * double(i % 9), double(i));
    const auto drawn = draw(materials, kDraws, 22);
    std::vector<BsdfQuery> there, back;
    std::vector<size_t> of;
    for (size_t i = 0; i < drawn.size(); ++i) {
        const SeenMaterial& seen = materials[i / kDraws];
        glm::vec3 wi(drawn[i].wi);
        if (i % 2 == 0)
            wi = direction(0.02 + 0.97 * double(i * 13 % 97) / 97, double(i)) * (i % 4 == 0 ? 1.f : -1.f);
        else if (drawn[i].value.w != 1)
            continue;
        const bool across = wi.z < 0;
        if (std::abs(wi.z) < 0.02f || (across && !resolvesRefraction(seen.material))) continue;
        const glm::vec3 flip(1, 1, across ? -1 : 1);
        ProbeMaterial behind = seen.material;
        if (across) behind.frontFace = 1 - behind.frontFace;
        there.push_back(partsQuery(seen.material, seen.wo, wi));
        back.push_back(partsQuery(behind, wi * flip, seen.wo * flip));
        of.push_back(i / kDraws);
    }
    const auto f = probe.ask(there), g = probe.ask(back);
    std::string faults;
    for (size_t i = 0; i < f.size(); ++i) {
        const ProbeMaterial& m = materials[of[i]].material;
        const bool across = there[i].other.z < 0;
        const double eta = across ? etaOf(m) : 1;
        double off = 0, largest = 0;
        for (int c = 0; c < 3; ++c) {
            const double diffuse = f[i].wi[c],
                         forth =
                             (diffuse + (f[i].value[c] - diffuse) * eta * eta) / std::abs(there[i].other.z),
                         reverse = g[i].value[c] / std::abs(back[i].other.z);
            // What is left of a float when the diffuse part is taken out of it.
            const double digits =
                across ? 0x1p-22 * f[i].value[c] * eta * eta / std::abs(there[i].other.z) : 0;
            off = std::max(off, (std::abs(forth - reverse) - digits) / (std::max(forth, reverse) + 1e-3));
            largest = std::max({largest, forth, reverse});
        }
        std::ostringstream what;
        what << "towards " << there[i].other.x << " " << there[i].other.y << " " << there[i].other.z
             << " not reciprocal by " << off << " of " << largest;
        // The digits of a half vector are those of its slopes: 1e-6 of α, and of |η − 1| where it refracts.
        const double smooth = std::max(std::min(m.alpha, m.alphaT < 0 ? m.alpha : m.alphaT), 1e-3f);
        if (!(off <= 1e-3 + 1e-6 / smooth / std::min(1.0, eta == 1 ? 1.0 : std::abs(eta - 1))))
            faults += named(materials[of[i]], what.str());
    }
    return faults;
}

void AnyMaterial::expectSoundMaterials(const Size& size) {
    // The furnace can tell: it lets white pass and nothing that is brighter.
    const SeenMaterial white{{.baseColor = glm::vec3(1), .alpha = 1, .ior = 1}, {0, 0, 1}};
    SeenMaterial bright = white;
    bright.material.baseColor = glm::vec3(1.02f);
    EXPECT_EQ(keepsEnergy({white}, size.furnace), "");
    EXPECT_NE(keepsEnergy({bright}, size.furnace), "");
    holds("finite, and no pdf below 0", size.cases, [&] { require(isFinite(anyMaterials(size))); });
    holds("draws agree with evaluation", size.cases,
          [&] { require(samplesAgreeWithEvaluation(anyMaterials(size))); });
    holds("no more light leaves than comes", size.cases,
          [&] { require(keepsEnergy(anyMaterials(size), size.furnace)); });
    holds("draws follow the pdf", size.cases, [&] {
        Size few = size;
        few.materials /= 3;
        require(samplesFollowThePdf(anyMaterials(few), size.draws));
    });
    holds("reciprocal but for coat and sheen", size.cases,
          [&] { require(isReciprocal(anyMaterials(size))); });
}

TEST_F(AnyMaterial, IsSound) {
    expectSoundMaterials(kQuick);
}
TEST_F(AnyMaterial, FullIsSound) {
    expectSoundMaterials(kFull);
}

}  // namespace
}  // namespace tilefarm
