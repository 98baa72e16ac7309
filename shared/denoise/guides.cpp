#include "shared/denoise/guides.h"

#include <algorithm>
#include <cmath>

namespace tilefarm {

namespace {

constexpr int kNoiseRadius = 1;   // over which measured variances are smoothed
constexpr int kSpreadRadius = 2;  // over which the spread stands for a variance that was not measured

// Squares of these, over the least reflectance and times the pixels of a patch, stay far from what fp32
// cannot hold.
constexpr float kMostRadiance = 1e15f;
constexpr float kMostVariance = 1e30f;

// Differences of features below these are no edges; squares.
constexpr float kLeastNormal = 1e-3f, kLeastAlbedo = 1e-3f, kLeastAlpha = 1e-3f;
// Squared distance at which surfaces, by sameSurface, begin to differ.
constexpr float kAlike = 0.1f;

// What is no number says nothing.
float numberOr0(float value) {
    return std::isnan(value) ? 0.f : value;
}

// Stands for the specular share of what is divided by albedo: that of a dielectric of index 1.5.
constexpr float kLeastReflectance = 0.04f;

}  // namespace

int Guides::reach() {
    return kNoiseRadius + kSpreadRadius;
}

void Guides::read(int first, const BandShape& band, int height, bool wrap, uint32_t threads,
                  const RowSource& source) {
    shape = band;
    resize();
    const int top = std::max(0, first - shape.margin);
    const int bottom = std::min(height, first + shape.rows + shape.margin);
    above_ = first - top;
    rows_.resize(static_cast<size_t>(bottom - top) * static_cast<size_t>(shape.width));
    source(static_cast<uint32_t>(top), static_cast<uint32_t>(bottom - top), rows_);
    forAll(shape.margin, threads, [&](int x, int y) {
        const int column =
            wrap ? (x % shape.width + shape.width) % shape.width : std::clamp(x, 0, shape.width - 1);
        const int row = std::clamp(first + y, 0, height - 1);
        const bool inside = row == first + y && (wrap || column == x);
        take(shape.at(x, y),
             static_cast<size_t>(row - top) * static_cast<size_t>(shape.width) + static_cast<size_t>(column),
             inside);
    });
    measureNoise(threads);
    measureGradients(threads);
}

void Guides::resize() {
    for (Colour* colour : {&radiance, &reflectance, &albedo, &normal})
        for (Plane& plane : *colour) plane.resize(shape.pixels());
    for (Plane* plane : {&depth, &alpha, &share, &measured, &noise, &normalGradient, &albedoGradient,
                         &alphaGradient, &depthGradient, &counts_})
        plane->resize(shape.pixels());
}

void Guides::take(size_t to, size_t from, bool inside) {
    const float a = std::clamp(numberOr0(rows_.alpha[from]), 0.f, 1.f);
    bool usable = inside && rows_.samples[from] > 0;
    measured[to] = 0;
    for (size_t c = 0; c < 3; ++c) {
        const float value = rows_.radiance[c][from];
        albedo[c][to] = std::clamp(numberOr0(rows_.albedo[c][from]), 0.f, 1.f);
        // What is seen past all surfaces is not divided.
        reflectance[c][to] =
            std::min(1.f, kLeastReflectance + (1 - kLeastReflectance) * (albedo[c][to] + (1 - a)));
        radiance[c][to] = std::clamp(numberOr0(value), -kMostRadiance, kMostRadiance) / reflectance[c][to];
        const float variance = std::max(0.f, numberOr0(rows_.variance[c][from]));
        measured[to] += std::min(variance / square(reflectance[c][to]), kMostVariance);
        normal[c][to] = std::clamp(numberOr0(rows_.normal[c][from]), -1.f, 1.f);
        usable = usable && std::abs(value) <= kMostRadiance;
    }
    depth[to] = a > 0 ? std::clamp(numberOr0(rows_.depth[from]) / a, 0.f, kMostRadiance) : 0;
    alpha[to] = a;
    counts_[to] = rows_.samples[from];
    share[to] = usable ? 1.f : 0.f;
}

// Smoothed, since a pixel that found none of its rare light measures too little; but never below what was
// measured, so that one that found it may be averaged, and without the largest neighbour, so that a single
// one does not open the pixels around it.
void Guides::measureNoise(uint32_t threads) {
    const int reachable = shape.margin - kSpreadRadius;
    forAll(reachable, threads, [&](int x, int y) {
        const size_t p = shape.at(x, y);
        if (counts_[p] < 2) measured[p] = spreadAround(x, y);
    });
    forAll(reachable - kNoiseRadius, threads, [&](int x, int y) {
        const size_t p = shape.at(x, y);
        float sum = 0, weights = 0, largest = 0, weightOfLargest = 0;
        for (int dy = -kNoiseRadius; dy <= kNoiseRadius; ++dy)
            for (int dx = -kNoiseRadius; dx <= kNoiseRadius; ++dx) {
                const size_t q = shape.at(x + dx, y + dy);
                const float w = sameSurface(p, q) * share[q];
                sum += w * measured[q];
                weights += w;
                if (w * measured[q] > largest) largest = w * measured[q], weightOfLargest = w;
            }
        const float others = weights - weightOfLargest;
        noise[p] = std::max(measured[p], others > 0 ? (sum - largest) / others : 0.f);
    });
}

float Guides::sameSurface(size_t p, size_t q) const {
    float apart = square(alpha[p] - alpha[q]);
    for (size_t c = 0; c < 3; ++c)
        apart += square(normal[c][p] - normal[c][q]) + square(albedo[c][p] - albedo[c][q]);
    return kernelOf(apart / kAlike);
}

// Variance of the neighbours about their mean, all channels together.
float Guides::spreadAround(int x, int y) const {
    float count = 0, spread = 0;
    std::array<float, 3> mean{};
    const auto forNeighbours = [&](const auto& work) {
        for (int dy = -kSpreadRadius; dy <= kSpreadRadius; ++dy)
            for (int dx = -kSpreadRadius; dx <= kSpreadRadius; ++dx)
                if (const size_t q = shape.at(x + dx, y + dy); share[q] > 0) work(q);
    };
    forNeighbours([&](size_t q) {
        count += 1;
        for (size_t c = 0; c < 3; ++c) mean[c] += (radiance[c][q] - mean[c]) / count;
    });
    forNeighbours([&](size_t q) {
        for (size_t c = 0; c < 3; ++c) spread += square(radiance[c][q] - mean[c]) / count;
    });
    return std::min(spread, kMostVariance);
}

// By central differences.
float Guides::gradient(const Plane& plane, size_t p) const {
    const auto stride = static_cast<size_t>(shape.stride());
    return square(0.5f * (plane[p + 1] - plane[p - 1])) +
           square(0.5f * (plane[p + stride] - plane[p - stride]));
}

// By the smaller of the differences to each side: an outline is no slope.
float Guides::slope(const Plane& plane, size_t p) const {
    const auto least = [&](size_t step) {
        return std::min(square(plane[p] - plane[p - step]), square(plane[p + step] - plane[p]));
    };
    return least(1) + least(static_cast<size_t>(shape.stride()));
}

void Guides::measureGradients(uint32_t threads) {
    forAll(shape.margin - 1, threads, [&](int x, int y) {
        const size_t p = shape.at(x, y);
        float normals = 0, albedos = 0;
        for (size_t c = 0; c < 3; ++c) {
            normals += gradient(normal[c], p);
            albedos += gradient(albedo[c], p);
        }
        normalGradient[p] = std::max(kLeastNormal, normals);
        albedoGradient[p] = std::max(kLeastAlbedo, albedos);
        alphaGradient[p] = std::max(kLeastAlpha, gradient(alpha, p));
        depthGradient[p] = slope(depth, p);
    });
}

}  // namespace tilefarm
