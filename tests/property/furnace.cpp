#include "tests/property/furnace.h"

#include <cmath>
#include <numbers>

namespace tilefarm {
namespace {

constexpr uint32_t kBatches = 32;
constexpr size_t kAtOnce = 4096;  // materials in a dispatch
constexpr double kFreedom = kBatches - 1;

/// One-sided tail of Student's distribution beyond t, by Simpson's rule in t = tanφ √ν, where its density is
/// cos^(ν−1)φ.
double studentTail(double t) {
    const double c =
        std::exp(std::lgamma((kFreedom + 1) / 2) - std::lgamma(kFreedom / 2)) / std::sqrt(std::numbers::pi);
    const double from = std::atan(t / std::sqrt(kFreedom)), to = std::numbers::pi / 2;
    constexpr int n = 2000;
    double sum = 0;
    for (int i = 0; i <= n; ++i)
        sum += (i == 0 || i == n ? 1
                : i % 2          ? 4
                                 : 2) *
               std::pow(std::cos(from + (to - from) * i / n), kFreedom - 1);
    return c * sum * (to - from) / (3 * n);
}

double studentLimit(double significance) {
    double low = 0, high = 60;
    for (int i = 0; i < 50; ++i)
        (studentTail((low + high) / 2) > significance ? low : high) = (low + high) / 2;
    return high;
}

/// Mean and its deviation from the means of batches.
Furnace merged(std::span<const BsdfAnswer> batches, uint32_t samples) {
    Furnace f;
    glm::dvec3 squares(0);
    for (const BsdfAnswer& a : batches) f.energy += glm::dvec3(a.wi) / double{kBatches};
    for (const BsdfAnswer& a : batches) {
        const glm::dvec3 off = glm::dvec3(a.wi) - f.energy;
        squares += off * off;
        f.unsound += double{a.wi.w};
    }
    f.sigma = glm::sqrt(squares / (kFreedom * kBatches));
    f.samples = samples;
    return f;
}

}  // namespace

std::vector<Furnace> furnace(BsdfProbe& probe, std::span<const SeenMaterial> materials,
                             const FurnaceEffort& effort) {
    std::vector<Furnace> furnaces(materials.size());
    std::vector<size_t> left(materials.size());
    for (size_t i = 0; i < left.size(); ++i) left[i] = i;
    double looks = 1;
    for (uint32_t n = effort.first; n < effort.last; n *= 4) ++looks;
    const double limit = studentLimit(effort.significance / (3 * looks * double(materials.size())));

    for (uint32_t samples = effort.first; !left.empty(); samples *= 4) {
        std::vector<size_t> again;
        for (size_t at = 0; at < left.size(); at += kAtOnce) {
            const std::span part(left.data() + at, std::min(kAtOnce, left.size() - at));
            std::vector<BsdfQuery> queries;
            for (const size_t i : part)
                queries.push_back(furnaceQuery(materials[i].material, materials[i].wo, samples / kBatches,
                                               static_cast<uint32_t>(i * 7919 + samples)));
            const auto answers = probe.ask(std::move(queries), kBatches);
            for (size_t k = 0; k < part.size(); ++k) {
                Furnace& f = furnaces[part[k]];
                f = merged(std::span(answers).subspan(k * kBatches, kBatches), samples);
                bool doubt = false;
                for (int c = 0; c < 3; ++c) {
                    f.tooMuch = f.tooMuch || f.energy[c] > effort.most + limit * f.sigma[c];
                    doubt = doubt || f.energy[c] > effort.most - 4 * f.sigma[c];
                }
                if (doubt && !f.tooMuch && f.unsound == 0 && samples < effort.last) again.push_back(part[k]);
            }
        }
        left = std::move(again);
    }
    return furnaces;
}

}  // namespace tilefarm
