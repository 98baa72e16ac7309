// Case 18: every lobe (lobe_table.h) draws directions as its pdf says, at every roughness, angle and stretch,
// mirrors included.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/lobe_table.h"
#include "tests/numerics/statistics.h"
#include "tests/shader/lobe_histogram.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

const std::vector<float> kAlphas{0, 1e-3f, 0.01f, 0.05f, 0.1f, 0.3f, 0.6f, 1};
const std::vector<double> kDegrees{0, 30, 60, 80, 85, 89, 89.9};

double cosineOf(double degrees) {
    return std::cos(degrees * pi / 180);
}

using Rows = std::vector<LobeRow>;

void append(Rows& rows, const Rows& more) {
    rows.insert(rows.end(), more.begin(), more.end());
}

/// All of the case with that stretch.
Rows rowsOf(float stretch, const std::vector<float>& alphas) {
    Rows rows = stretch == 1 ? diffuseLobes() : Rows{};
    for (const float alpha : alphas) {
        append(rows, facetLobes(alpha, stretch));
        if (stretch > 1) continue;
        append(rows, hazeLobes(alpha));
        append(rows, layeredLobes(alpha));
    }
    return rows;
}

class HardLobeHistograms : public LobeTest {
protected:
    void expectRowsToFollowThePdf(const Rows& rows, const std::vector<double>& degrees, double phi = 0.4) {
        for (const LobeRow& row : rows)
            for (const double angle : degrees) expectChiSquare(row, cosineOf(angle), phi);
    }
    void expectAllToFollowThePdf(float stretch, double phi) {
        for (const float each : kStretches) familySize += rowsOf(each, kAlphas).size() * kDegrees.size();
        expectRowsToFollowThePdf(rowsOf(stretch, kAlphas), kDegrees, phi);
    }
};

TEST_F(HardLobeHistograms, HardCase18_DirectionsFollowThePdf) {
    // Each lobe once: neighbours of the table take turns with roughness and angle.
    std::vector<Rows> byAlpha;
    for (const float alpha : {1e-3f, 0.05f, 0.6f}) {
        byAlpha.push_back(basicLobes(alpha));
        for (const Rows& more :
             {hazeLobes(alpha), layeredLobes(alpha), diffuseLobes(), plainLobes(alpha, 25)})
            append(byAlpha.back(), more);
    }
    for (size_t i = 0; i < byAlpha[0].size(); ++i) {
        const LobeRow& row = byAlpha[i % 3][i];
        expectChiSquare(row, cosineOf(i % 2 == 0 ? 30 : 89), row.material.alphaT < 0 ? 0.4 : 1.2);
    }
}
TEST_F(HardLobeHistograms, FullHardCase18_DirectionsFollowThePdf) {
    expectAllToFollowThePdf(1, 0.4);
}
TEST_F(HardLobeHistograms, FullHardCase18_DirectionsOfFacetsStretchedBy4FollowThePdf) {
    expectAllToFollowThePdf(4, 0.4);
}
TEST_F(HardLobeHistograms, FullHardCase18_DirectionsOfFacetsStretchedBy25FollowThePdf) {
    expectAllToFollowThePdf(25, 1.2);
}

}  // namespace
}  // namespace tilefarm
