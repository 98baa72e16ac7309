// Case 50: Smith's masking and the distributions of GGX, Beckmann and Phong at their ends, by the shaders'
// own code.
#include <cmath>
#include <numbers>

#include "tests/numerics/probe_runner.h"
#include "tests/numerics/statistics.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/lobe_checks.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr float kAlphas[]{1e-3f, 0.01f, 0.1f, 0.3f, 0.7f, 1.0f};

struct Facet {
    glm::vec3 masking, distribution;  // of GGX, Beckmann, Phong
    double exponent = 0;
};

class HardMasking : public DeviceTest {
protected:
    std::vector<Facet> ask(const std::vector<glm::vec4>& queries) {
        const auto values =
            Probe(device).run(PROBE_MASKING, static_cast<uint32_t>(queries.size()), queries, 3).values;
        std::vector<Facet> facets;
        for (size_t i = 0; i < queries.size(); ++i)
            facets.push_back({glm::vec3(values[3 * i]), glm::vec3(values[3 * i + 1]),
                              static_cast<double>(values[3 * i + 2].x)});
        return facets;
    }
};

TEST_F(HardMasking, HardCase50_NormalIncidenceIsNotMasked) {
    std::vector<glm::vec4> queries;
    for (const float alpha : kAlphas)
        for (const float z : {1.0f, 1 + 0x1p-23f, 1 + 0x1p-20f})  // as n·v rounds
            for (const float aside : {0.0f, 1e-38f, 1e-30f, 1e-12f, 1e-6f})
                queries.emplace_back(aside, -aside, z, alpha);
    const auto facets = ask(queries);
    for (size_t i = 0; i < facets.size(); ++i)
        for (int kind = 0; kind < 3; ++kind)
            EXPECT_EQ(facets[i].masking[kind], 1) << "kind " << kind << " z " << queries[i].z << " sine "
                                                  << queries[i].x << " alpha " << queries[i].w;
}

/// Smith's G1 for Beckmann's slopes.
double exactBeckmann(double tangent, double alpha) {
    const double a = 1 / (alpha * tangent);
    return 1 / (1 + 0.5 * (std::exp(-a * a) / (a * std::sqrt(pi)) - std::erfc(a)));
}

/// Smith's G1 for slopes distributed as Student's t, which are those of cosⁿθ: Λ = ∫ (t − cotθ) p(t) dt /
/// cotθ over the slopes t beyond cotθ, by Simpson's rule in t = cotθ + x / (1 − x).
double exactPhong(double tangent, double alpha) {
    const double nu = 2 / (alpha * alpha), cotangent = 1 / tangent;
    const double scale =
        std::exp(std::lgamma((nu + 1) / 2) - std::lgamma(nu / 2)) / std::sqrt(pi);  // of (1 + t²)^(−(ν+1)/2)
    constexpr int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double x = double(i) / n, weight = i == 0 ? 1 : i % 2 ? 4 : 2;
        const double further = x / (1 - x), t = cotangent + further;
        sum += weight * further * scale * std::exp(-(nu + 1) / 2 * std::log1p(t * t)) / ((1 - x) * (1 - x));
    }
    return 1 / (1 + sum / (3.0 * n) * tangent);
}

TEST_F(HardMasking, HardCase50_MaskingEqualsDoublePrecision) {
    std::vector<glm::vec4> queries;
    for (const float alpha : kAlphas)
        for (const double cosTheta : {1e-7, 1e-5, 1e-3, 0.05, 0.3, 0.7, 0.95, 0.9999})
            queries.emplace_back(directionAt(cosTheta), alpha);
    const auto facets = ask(queries);
    for (size_t i = 0; i < facets.size(); ++i) {
        const glm::dvec4 q(queries[i]);
        SCOPED_TRACE(testing::Message() << "cos " << q.z << " alpha " << q.w);
        const double tangent = std::hypot(q.x, q.y) / q.z;
        const double ggx = 2 / (1 + std::sqrt(1 + q.w * q.w * tangent * tangent));
        for (int kind = 0; kind < 3; ++kind) {
            ASSERT_TRUE(std::isfinite(facets[i].masking[kind]));
            EXPECT_GE(facets[i].masking[kind], 0);
            EXPECT_LE(facets[i].masking[kind], 1);
        }
        EXPECT_NEAR(facets[i].masking[0], ggx, 1e-6 * ggx);
        const double beckmann = exactBeckmann(tangent, q.w);
        recordWorst("beckmann", std::abs(facets[i].masking[1] - beckmann));
        EXPECT_NEAR(facets[i].masking[1], beckmann, 1e-6);
        // Wallace's approximation of the tail is good to 2e-3; narrow lobes are taken as Beckmann's, which
        // they are to O(α²).
        const double phong = q.w < 0.1 ? beckmann : exactPhong(tangent, q.w);
        recordWorst("phong", std::abs(facets[i].masking[2] - phong));
        EXPECT_NEAR(facets[i].masking[2], phong, 3e-3);
    }
}

TEST_F(HardMasking, HardCase50_PhongsExponentIsThatOfBeckmannsRoughness) {
    // n + 2 = 2 / α²: from the flat distribution 1/π at α = 1 to a needle of 2e6.
    std::vector<glm::vec4> queries;
    for (const float alpha : kAlphas)
        for (const double slope : {0.0, 1e-3, 0.5, 1.0, 2.0})  // in α
            queries.emplace_back(directionAt(1 / std::hypot(1.0, slope * double{alpha})), alpha);
    const auto facets = ask(queries);
    for (size_t i = 0; i < facets.size(); ++i) {
        const glm::dvec4 q(queries[i]);
        SCOPED_TRACE(testing::Message() << "cos " << q.z << " alpha " << q.w);
        const double sine2 = q.x * q.x + q.y * q.y, a2 = q.w * q.w, exponent = 2 / a2 - 2;
        // The kernel's direction is rounded: its sine has the digits, so cosⁿθ comes from there.
        const double phong = (exponent + 2) / (2 * pi) * std::exp(exponent / 2 * std::log1p(-sine2));
        const double z2 = 1 - sine2;
        const double beckmann = std::exp(-sine2 / (z2 * a2)) / (pi * a2 * z2 * z2);
        recordWorst("D", std::abs(facets[i].distribution[2] - phong) / phong);
        EXPECT_NEAR(facets[i].distribution[1], beckmann, 1e-5 * beckmann);
        EXPECT_NEAR(facets[i].distribution[2], phong, 1e-5 * phong);
    }
}

TEST_F(HardMasking, HardCase50_ExponentsOfShadingAreFiniteAtBothEnds) {
    double last = INFINITY;
    for (const float alpha : {0.0f, 1e-30f, 1e-8f, 1e-3f, 0.1f, 0.5f, 0.9f, 1.0f}) {
        const double exponent = ask({glm::vec4(0, 0, 1, alpha)}).front().exponent;
        ASSERT_TRUE(std::isfinite(exponent)) << alpha;
        EXPECT_GE(exponent, 1) << alpha;
        EXPECT_LE(exponent, last) << "rougher is wider";
        const double a2 = double{alpha} * double{alpha};
        if (alpha >= 0.1f && alpha <= 0.8f) {
            EXPECT_NEAR(exponent, 2 / a2 - 2, 1e-5 * exponent);
        }
        last = exponent;
    }
}

}  // namespace
}  // namespace tilefarm
