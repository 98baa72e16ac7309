// Every light against its own pdf: sampled directions follow it, it integrates to 1, and what a sample says
// of itself is what a ray that meets the light would be told. Through the real shader code.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/shader/light_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

struct Cone {
    glm::dvec3 x, y, z;
    double cosine;

    explicit Cone(const LightScene& s) : z(s.towards), cosine(s.cosCone) {
        x = glm::normalize(glm::cross(z, std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
        y = glm::cross(z, x);
    }
    /// Equal areas of the unit square are equal solid angles.
    glm::vec3 direction(double s, double t) const {
        const double c = 1 - s * (1 - cosine), r = std::sqrt(std::max(0.0, 1 - c * c));
        return {x * (r * std::cos(2 * pi * t)) + y * (r * std::sin(2 * pi * t)) + z * c};
    }
    bool invert(const glm::dvec3& d, double& s, double& t) const {
        // By the chord, which keeps the digits of a narrow cone.
        const glm::dvec3 chord = glm::normalize(d) - z;
        s = glm::dot(chord, chord) / 2 / (1 - cosine);
        t = std::atan2(glm::dot(d, y), glm::dot(d, x)) / (2 * pi);
        if (t < 0) t += 1;
        return s < 1;
    }
};

LightQuery query(const LightScene& s, uint32_t mode) {
    LightQuery q{};
    q.position = glm::vec4(glm::vec3(s.point), 0);
    q.normal = {0, 1, 0, 0};
    q.ask.x = mode;
    return q;
}

std::vector<LightQuery> samples(const LightScene& s, uint32_t count) {
    std::mt19937 random(17);
    std::vector<LightQuery> queries(count, query(s, PROBE_SAMPLE));
    for (uint32_t i = 0; i < count; ++i) {
        queries[i].bits = {random(), random(), random(), random()};
        queries[i].ask.z = i;
    }
    return queries;
}

class LightSamplingTest : public DeviceTest, public testing::WithParamInterface<size_t> {
protected:
    LightScene light = lightsWithExtent()[GetParam()];
    LightProbe probe{device, light.scene};
};

TEST_P(LightSamplingTest, DirectionsFollowThePdf) {
    constexpr size_t kCells = 16, kFine = 16, kSamples = 40000;
    // The textured lamp is two triangles, sampled one at a time: the first.
    const Cone cone(light);
    std::vector<LightQuery> grid;
    for (size_t i = 0; i < kCells * kFine; ++i)
        for (size_t j = 0; j < kCells * kFine; ++j) {
            LightQuery q = query(light, PROBE_PDF);
            q.direction = glm::vec4(
                cone.direction((double(i) + .5) / (kCells * kFine), (double(j) + .5) / (kCells * kFine)), 0);
            grid.push_back(q);
        }
    std::vector<double> expected(kCells * kCells), seen(kCells * kCells), rough(kCells * kCells);
    const double solidAngle = 2 * pi * (1 - cone.cosine) / double(grid.size());
    const auto pdfs = probe.ask(grid);
    double total = 0;
    std::vector<double> least(kCells * kCells, 1e30), most(kCells * kCells);
    for (size_t i = 0; i < pdfs.size(); ++i) {
        const size_t cell = i / (kCells * kFine) / kFine * kCells + i % (kCells * kFine) / kFine;
        const double share = double{pdfs[i].wi.w} * solidAngle;
        expected[cell] += share * kSamples;
        least[cell] = std::min(least[cell], share);
        most[cell] = std::max(most[cell], share);
        total += share;
    }
    EXPECT_NEAR(total, 1, 0.02);
    double drawn = 0;
    for (const LightAnswer& a : probe.ask(samples(light, kSamples))) {
        if (a.radiance.w == 0) continue;
        double s, t;
        ASSERT_TRUE(cone.invert(glm::dvec3(a.wi), s, t)) << s;
        ++seen[std::min(static_cast<size_t>(s * kCells), kCells - 1) * kCells +
               std::min(static_cast<size_t>(t * kCells), kCells - 1)];
        ++drawn;
    }
    EXPECT_EQ(drawn, kSamples);
    double chi2 = 0;
    int cells = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
        if (expected[i] < 20) continue;
        // A cell that the light's edge crosses is known to as many fine cells as its border may cut.
        const double edge = least[i] == 0 ? 0.5 * kFine * most[i] * kSamples : 0;
        const double slack = 0.01 * expected[i] + edge;
        chi2 += std::pow(seen[i] - expected[i], 2) / (expected[i] + slack * slack);
        ++cells;
    }
    ASSERT_GT(cells, 10);
    EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells)) << cells << " cells";
}

TEST_P(LightSamplingTest, ARayThatMeetsASampleIsToldThePdfThatItWasDrawnWith) {
    const auto drawn = probe.ask(samples(light, 4000));
    std::vector<LightQuery> queries;
    std::vector<float> pdfs;
    for (const LightAnswer& a : drawn) {
        if (a.radiance.w == 0) continue;
        EXPECT_NEAR(glm::length(glm::vec3(a.wi)), 1, 1e-6);
        LightQuery q = query(light, PROBE_PDF);
        q.direction = glm::vec4(glm::vec3(a.wi), 0);
        queries.push_back(q);
        pdfs.push_back(a.wi.w);
    }
    ASSERT_GT(queries.size(), 3000u);
    const auto asked = probe.ask(queries);
    size_t missed = 0;
    for (size_t i = 0; i < asked.size(); ++i) {
        // A sample on the very edge may round to a ray beside the light.
        if (asked[i].wi.w == 0) {
            ++missed;
            continue;
        }
        EXPECT_NEAR(asked[i].wi.w, pdfs[i], 2e-3 * pdfs[i]) << i;
    }
    EXPECT_LE(missed, asked.size() / 500);
}

INSTANTIATE_TEST_SUITE_P(Every, LightSamplingTest, testing::Range(size_t{0}, lightsWithExtent().size()),
                         nameOfLight);

}  // namespace
}  // namespace tilefarm
