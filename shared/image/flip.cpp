#include "shared/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

// Section numbers are those of the paper.

namespace tilefarm {
namespace {

using Vec = std::array<double, 3>;
using Plane = std::vector<double>;
using Kernel = std::vector<double>;  // of odd length, about its middle

constexpr double kColourExponent = 0.7;                       // q_c of section 4.1.4
constexpr double kKnee = 0.4, kKneeError = 0.95;              // p_c and p_t
constexpr double kFeatureExponent = 0.5;                      // q_f of section 4.2
constexpr double kFeatureWidth = 0.082;                       // degrees, w
constexpr Vec kWhite{0.950428545, 1.000000000, 1.088900371};  // XYZ of sRGB's white, D65

// sRGB (IEC 61966-2-1) to XYZ and back, as the authors have it: rows add up to their white.
Vec xyzOf(const Vec& c) {
    constexpr double r = 24577794, g = 12288897, b = 73733382;
    return {(10135552 * c[0] + 8788810 * c[1] + 4435075 * c[2]) / r,
            (2613072 * c[0] + 8788810 * c[1] + 887015 * c[2]) / g,
            (1425312 * c[0] + 8788810 * c[1] + 70074185 * c[2]) / b};
}

Vec rgbOf(const Vec& c) {
    return {3.241003275 * c[0] - 1.537398934 * c[1] - 0.498615861 * c[2],
            -0.969224334 * c[0] + 1.875930071 * c[1] + 0.041554224 * c[2],
            0.055639423 * c[0] - 0.204011202 * c[1] + 1.057148933 * c[2]};
}

// The linear opponent space of section 4.1.1.
Vec opponentOf(const Vec& rgb) {
    const Vec xyz = xyzOf(rgb);
    const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Vec rgbOfOpponent(const Vec& c) {
    const double y = (c[0] + 16) / 116;
    return rgbOf({(y + c[1] / 500) * kWhite[0], y * kWhite[1], (y - c[2] / 200) * kWhite[2]});
}

// CIELAB with Hunt's adjustment: dark colours look less colourful (section 4.1.2).
Vec huntLabOf(const Vec& rgb) {
    const auto f = [](double t) {
        constexpr double delta = 6.0 / 29;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
    };
    const Vec xyz = xyzOf(rgb);
    const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
    const double lightness = 116 * y - 16;
    return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

// HyAB, for large distances (section 4.1.3).
double distance(const Vec& a, const Vec& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

struct Picture {
    int width = 0, height = 0;
    std::array<Plane, 3> planes;
    size_t at(int x, int y) const {  // borders go on as they end
        return static_cast<size_t>(std::clamp(y, 0, height - 1)) * static_cast<size_t>(width) +
               static_cast<size_t>(std::clamp(x, 0, width - 1));
    }
    Vec pixel(size_t i) const { return {planes[0][i], planes[1][i], planes[2][i]}; }
};

double linearOf(unsigned char code) {
    const double encoded = code / 255.0;
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Picture shown(const FloatImage& image, const ToneMapping& tone) {
    Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
    const auto &r = image.plane("R"), &g = image.plane("G"), &b = image.plane("B");
    for (Plane& plane : picture.planes) plane.resize(r.size());
    for (size_t i = 0; i < r.size(); ++i) {
        const auto code = toDisplay({r[i], g[i], b[i]}, tone);
        const Vec c = opponentOf({linearOf(code[0]), linearOf(code[1]), linearOf(code[2])});
        for (size_t k = 0; k < 3; ++k) picture.planes[k][i] = c[k];
    }
    return picture;
}

Plane filtered(const Picture& picture, const Plane& plane, const Kernel& across, const Kernel& down) {
    Plane between(plane.size()), result(plane.size());
    const auto pass = [&](const Plane& from, Plane& to, const Kernel& kernel, int dx, int dy) {
        const int radius = static_cast<int>(kernel.size() / 2);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                double sum = 0;
                for (int k = -radius; k <= radius; ++k)
                    sum += kernel[static_cast<size_t>(k + radius)] * from[picture.at(x + k * dx, y + k * dy)];
                to[picture.at(x, y)] = sum;
            }
    };
    pass(plane, between, across, 1, 0);
    pass(between, result, down, 0, 1);
    return result;
}

// One Gaussian of a contrast sensitivity function (section 4.1.1): exp(−π² d² / b), d in degrees.
Kernel sensitivity(double b, double pixelsPerDegree, int radius) {
    constexpr double pi = std::numbers::pi;
    Kernel kernel;
    for (int k = -radius; k <= radius; ++k) {
        const double degrees = k / pixelsPerDegree;
        kernel.push_back(std::exp(-pi * pi * degrees * degrees / b));
    }
    return kernel;
}

struct Gaussian {
    double a, b;
};
struct Channel {
    Gaussian first, second;
};
constexpr std::array kSensitivity{Channel{{1, 0.0047}, {0, 1e-5}},        // achromatic
                                  Channel{{1, 0.0053}, {0, 1e-5}},        // red-green
                                  Channel{{34.1, 0.04}, {13.5, 0.025}}};  // blue-yellow
constexpr double kWidestSensitivity = 0.04;

double sumOf(const Kernel& kernel) {
    double sum = 0;
    for (const double value : kernel) sum += value;
    return sum;
}

// What the eye resolves of the channels. A two-dimensional Gaussian is a product; the sum of two is not, so
// each is filtered alone.
void blur(Picture& picture, double pixelsPerDegree) {
    constexpr double pi = std::numbers::pi;
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(kWidestSensitivity / (2 * pi * pi)) * pixelsPerDegree));
    for (size_t c = 0; c < 3; ++c) {
        Plane sum(picture.planes[c].size());
        double weight = 0;
        for (const Gaussian& g : {kSensitivity[c].first, kSensitivity[c].second}) {
            if (g.a == 0) continue;
            const Kernel kernel = sensitivity(g.b, pixelsPerDegree, radius);
            const double scale = g.a * std::sqrt(pi / g.b);
            const Plane part = filtered(picture, picture.planes[c], kernel, kernel);
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += scale * part[i];
            weight += scale * sumOf(kernel) * sumOf(kernel);
        }
        for (double& value : sum) value /= weight;
        picture.planes[c] = std::move(sum);
    }
}

Vec seenColour(const Picture& blurred, size_t i) {
    Vec rgb = rgbOfOpponent(blurred.pixel(i));
    for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
    return huntLabOf(rgb);
}

// Section 4.1.4: large differences are pressed into the last twentieth.
double colourError(double hyab) {
    static const double most =
        std::pow(distance(huntLabOf({0, 1, 0}), huntLabOf({0, 0, 1})), kColourExponent);
    const double error = std::pow(hyab, kColourExponent), knee = kKnee * most;
    return error < knee ? kKneeError / knee * error
                        : kKneeError + (error - knee) / (most - knee) * (1 - kKneeError);
}

// Derivatives of a Gaussian by their order, their positive and negative parts scaled to 1 each (section 4.2).
Kernel derivative(int order, double deviation, int radius) {
    Kernel kernel;
    double positive = 0, negative = 0;
    for (int k = -radius; k <= radius; ++k) {
        const double g = std::exp(-k * k / (2 * deviation * deviation));
        const double value = order == 0 ? g : order == 1 ? -k * g : (k * k / (deviation * deviation) - 1) * g;
        kernel.push_back(value);
        (value > 0 ? positive : negative) += std::abs(value);
    }
    for (double& value : kernel) value /= value > 0 ? positive : negative;
    return kernel;
}

Plane features(const Picture& picture, int order, double pixelsPerDegree) {
    const double deviation = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    Plane grey = picture.planes[0];
    for (double& value : grey) value = (value + 16) / 116;
    const Kernel smooth = derivative(0, deviation, radius), detect = derivative(order, deviation, radius);
    Plane strength = filtered(picture, grey, detect, smooth);
    const Plane down = filtered(picture, grey, smooth, detect);
    for (size_t i = 0; i < strength.size(); ++i) strength[i] = std::hypot(strength[i], down[i]);
    return strength;
}

}  // namespace

double meanFlip(const FloatImage& test, const FloatImage& reference, const ToneMapping& tone,
                double pixelsPerDegree) {
    Picture a = shown(test, tone), b = shown(reference, tone);
    const Plane edgesA = features(a, 1, pixelsPerDegree), edgesB = features(b, 1, pixelsPerDegree);
    const Plane pointsA = features(a, 2, pixelsPerDegree), pointsB = features(b, 2, pixelsPerDegree);
    blur(a, pixelsPerDegree);
    blur(b, pixelsPerDegree);
    double sum = 0;
    for (size_t i = 0; i < edgesA.size(); ++i) {
        const double colour = colourError(distance(seenColour(a, i), seenColour(b, i)));
        const double step = std::max(std::abs(edgesA[i] - edgesB[i]), std::abs(pointsA[i] - pointsB[i]));
        const double feature = std::pow(step / std::numbers::sqrt2, kFeatureExponent);
        sum += std::pow(colour, 1 - feature);  // section 4.3
    }
    return sum / static_cast<double>(edgesA.size());
}

}  // namespace tilefarm
