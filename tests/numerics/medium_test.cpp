// Cases of HARD-CASES.md about media: phase functions and free flights.
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/numerics/probe_runner.h"
#include "tests/numerics/statistics.h"
#include "tests/shader/device_fixture.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardMedium : public DeviceTest {
protected:
    Probe probe{device};
};

constexpr std::array kAnisotropies{0.9f, -0.9f, 0.99f,  -0.99f, 0.9999f, -0.9999f,
                                   0.5f, 1e-3f, -1e-6f, 1e-20f, 0.f};

/// Of a given h = 1 − cos θ around the axis that is preferred, and |g|.
double henyeyGreenstein(double strength, double h) {
    return (1 - strength * strength) /
           (4 * pi * std::pow((1 - strength) * (1 - strength) + 2 * strength * h, 1.5));
}

/// Share of light scattered within h of that axis: the integral of the above.
double shareWithin(double strength, double h) {
    // (1 + s)(1 / a − 1 / √(a² + 2 s h)) / (2 s) · a …, a = 1 − s, without the difference of near equals.
    const double a = 1 - strength, r = std::sqrt(a * a + 2 * strength * h);
    return (1 + strength) * h / (r * (r + a));
}

/// At an angle of 1 − cos θ = h and φ around +x.
glm::dvec3 aroundX(double h, double phi) {
    const double sine = std::sqrt(h * (2 - h));
    return {1 - h, sine * std::cos(phi), sine * std::sin(phi)};
}

TEST_F(HardMedium, HardCase29_PhaseFunctionIsNormalised) {
    for (const float g : kAnisotropies) {
        // Nodes even in ln h, from where nothing is left to add.
        constexpr int n = 4000;
        const double first = std::log(1e-13), step = (std::log(2.0) - first) / n, strength = std::abs(g);
        std::vector<glm::vec4> queries;
        for (int i = 0; i <= n; ++i) {
            const double h = std::min(std::exp(first + step * i), 2.0);
            queries.emplace_back(std::copysign(1.f, g), 0, 0, g);
            queries.emplace_back(glm::vec3(aroundX(h, 0.1 * i)), 0);
        }
        const auto values = probe.run(PROBE_PHASE, n + 1, queries, 1).values;
        double sum = 0, furthest = 0;
        for (int i = 0; i <= n; ++i) {
            const double h = std::min(std::exp(first + step * i), 2.0), pdf = double{values[size_t(i)].x};
            ASSERT_TRUE(std::isfinite(pdf) && pdf > 0) << "g " << g << " h " << h;
            furthest = std::max(furthest, std::abs(pdf / henyeyGreenstein(strength, h) - 1));
            sum += 2 * pi * pdf * h * step * (i == 0 || i == n ? 0.5 : 1);
        }
        recordWorst("normalisation", std::abs(sum - 1));
        recordWorst("relative", furthest);
        EXPECT_NEAR(sum, 1, 0.01) << "g " << g;
        EXPECT_LT(furthest, strength < 0.995 ? 1e-3 : 0.01) << "g " << g;
    }
}

TEST_F(HardMedium, HardCase29_SamplesFollowThePhaseFunction) {
    constexpr uint32_t n = 1 << 16;
    constexpr size_t kRings = 24, kSectors = 8;
    for (const float g : kAnisotropies) {
        SCOPED_TRACE(g);
        const glm::dvec3 travel = glm::normalize(glm::dvec3(0.3, -0.5, 0.8)), axis = g < 0 ? -travel : travel;
        const glm::dvec3 x = glm::normalize(glm::cross(axis, glm::dvec3(0, 1, 0))), y = glm::cross(axis, x);
        const auto values = probe.run(PROBE_PHASE_SAMPLES, n, {glm::vec4(glm::vec3(travel), g)}, 2).values;
        std::vector<double> counts(kRings * kSectors),
            expected(counts.size(), double(n) / double(counts.size()));
        double sum = 0, squares = 0;
        for (uint32_t i = 0; i < n; ++i) {
            const glm::dvec3 wi(values[2 * i]);
            ASSERT_NEAR(glm::length(wi), 1, 1e-6);
            // Their rounding moves directions by 1e-7 where the lobe is 1e-4 wide.
            ASSERT_NEAR(values[2 * i].w / values[2 * i + 1].x, 1, std::abs(g) < 0.995f ? 1e-3 : 0.01);
            const glm::dvec3 chord = glm::normalize(wi) - axis;
            const double h = std::min(0.5 * glm::dot(chord, chord), 2.0);
            const double v = shareWithin(std::abs(double{g}), h),
                         phi = std::atan2(glm::dot(wi, y), glm::dot(wi, x));
            const auto bin = [](double share, size_t bins) {
                return std::min(static_cast<size_t>(std::max(share, 0.0) * double(bins)), bins - 1);
            };
            ++counts[bin(v, kRings) * kSectors + bin(0.5 + phi / (2 * pi), kSectors)];
            sum += h;
            squares += h * h;
        }
        expectChiSquare(counts, expected);
        const double mean = sum / n;
        expectMean({mean, std::sqrt((squares / n - mean * mean) / n)}, 1 - std::abs(double{g}), 1e-9);
    }
}

TEST_F(HardMedium, HardCase29_TowardsIsotropy) {
    const auto sampled = [&](float g) {
        return probe.run(PROBE_PHASE_SAMPLES, 4096, {glm::vec4(0, 0, 1, g)}, 2).values;
    };
    const auto isotropic = sampled(0);
    for (const float g : {1e-3f, 1e-5f, 1e-8f, 1e-30f, std::numeric_limits<float>::denorm_min()}) {
        const auto near = sampled(g);
        for (size_t i = 0; i < isotropic.size(); i += 2) {
            ASSERT_LE(glm::length(glm::vec3(near[i]) - glm::vec3(isotropic[i])), 2 * g + 1e-6f) << g;
            ASSERT_NEAR(near[i].w * 4 * pi, 1, 4 * g + 1e-6) << g;
        }
    }
}

TEST_F(HardMedium, HardCase29_FreeFlightsKeepTheirDigitsAtBothEnds) {
    std::mt19937 random(29);
    std::vector<glm::vec4> queries;
    std::vector<double> expected;
    const auto ask = [&](uint32_t high, uint32_t low) {
        queries.emplace_back(std::bit_cast<float>(high), std::bit_cast<float>(low), 0, 0);
        const double part = ((high & 0x7fffffffu) + (low >> 8) * 0x1p-24) * 0x1p-32;
        expected.push_back((high >> 31) != 0 ? -std::log(std::max(part, 1e-18)) : -std::log1p(-part));
    };
    for (const uint32_t high : {0u, 1u, 0x7ffffu, 0x7effffffu, 0x80000000u, 0x80000001u, 0xfeffffffu})
        for (const uint32_t low : {0u, 0x100u, 0xffffff00u}) ask(high, low);
    while (queries.size() < 10000) {
        const uint32_t high = random() >> (random() % 20), low = random();
        if ((high >> 23 & 0xff) != 0xff && (low >> 23 & 0xff) != 0xff) ask(high, low);  // no NaN on their way
    }
    const auto count = static_cast<uint32_t>(queries.size());
    const auto values = probe.run(PROBE_EXPONENTIAL, count, queries, 1).values;
    for (uint32_t i = 0; i < count; ++i) {
        if (expected[i] > 0) recordWorst("relative", std::abs(values[i].x / expected[i] - 1));
        EXPECT_NEAR(values[i].x, expected[i], 2e-6 * expected[i]);
    }
}

}  // namespace
}  // namespace tilefarm
