#include "worker/render/environment_irradiance.h"

#include <cmath>
#include <numbers>

namespace tilefarm {
namespace {

using std::numbers::pi;

/// Squared factors of the real spherical harmonics times what the clamped cosine does to their band: π, 2π/3,
/// π/4.
constexpr std::array<double, 9> kFactors{
    pi / (4 * pi),           2 * pi / 3 * 3 / (4 * pi), 2 * pi / 3 * 3 / (4 * pi), 2 * pi / 3 * 3 / (4 * pi),
    pi / 4 * 15 / (4 * pi),  pi / 4 * 15 / (4 * pi),    pi / 4 * 5 / (16 * pi),    pi / 4 * 15 / (4 * pi),
    pi / 4 * 15 / (16 * pi),
};

/// ∫ of products of sine and cosine over the polar angle of a row, with sinθ dθ; or over a column's azimuth.
struct Row {
    double one, cos, sin, sinCos, sinSquared, cosSquared;
    Row(double upper, double lower) {
        const double cu = std::cos(upper), cl = std::cos(lower), su = std::sin(upper), sl = std::sin(lower);
        one = cu - cl;
        cos = (sl * sl - su * su) / 2;
        sin = (lower - upper) / 2 - (sl * cl - su * cu) / 2;
        sinCos = (sl * sl * sl - su * su * su) / 3;
        cosSquared = (cu * cu * cu - cl * cl * cl) / 3;
        sinSquared = one - cosSquared;
    }
};
struct Column {
    double one, cos, sin, sinCos, sinSquared, cosSquared;
    Column(double from, double to) {
        const double sf = std::sin(from), st = std::sin(to), cf = std::cos(from), ct = std::cos(to);
        one = to - from;
        cos = st - sf;
        sin = cf - ct;
        sinCos = (st * st - sf * sf) / 2;
        cosSquared = one / 2 + (st * ct - sf * cf) / 2;
        sinSquared = one - cosSquared;
    }
};

/// Of the polynomials that the header names, in its order, over a texel; with y = cosθ, x = sinθ cosφ.
std::array<double, 9> integrals(const Row& r, const Column& c) {
    const double solidAngle = r.one * c.one;
    return {solidAngle,
            r.cos * c.one,
            r.sin * c.sin,
            r.sin * c.cos,
            r.sinCos * c.cos,
            r.sinCos * c.sin,
            3 * r.sinSquared * c.sinSquared - solidAngle,
            r.sinSquared * c.sinCos,
            r.sinSquared * c.cosSquared - r.cosSquared * c.one};
}

}  // namespace

std::array<glm::vec4, 9> environmentIrradiance(const Environment& environment) {
    const Image& image = environment.image;
    if (image.rgbaFloat.empty()) return {};
    std::vector<Column> columns;
    for (uint32_t x = 0; x < image.width; ++x)
        columns.emplace_back(2 * pi * (double(x) / image.width - 0.5),
                             2 * pi * (double(x + 1) / image.width - 0.5));
    std::array<glm::dvec3, 9> sums{};
    for (uint32_t y = 0; y < image.height; ++y) {
        const Row row(pi * y / image.height, pi * (y + 1) / image.height);
        for (uint32_t x = 0; x < image.width; ++x) {
            const auto shares = integrals(row, columns[x]);
            const float* rgba = &image.rgbaFloat[4 * (size_t{y} * image.width + x)];
            for (size_t i = 0; i < sums.size(); ++i)
                sums[i] += shares[i] * glm::dvec3(rgba[0], rgba[1], rgba[2]);
        }
    }
    std::array<glm::vec4, 9> coefficients;
    for (size_t i = 0; i < sums.size(); ++i) coefficients[i] = glm::vec4(glm::vec3(sums[i] * kFactors[i]), 0);
    return coefficients;
}

}  // namespace tilefarm
