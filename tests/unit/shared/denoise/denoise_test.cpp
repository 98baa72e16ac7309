#include "shared/denoise/denoise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "shared/error/error.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;
using Colour = std::array<std::vector<float>, 3>;

// A frame of one flat grey surface; tests change what they are about.
struct Frame {
    uint32_t width, height;
    GuidedRows planes{};

    Frame(uint32_t w, uint32_t h) : width(w), height(h) {
        planes.resize(pixels());
        for (size_t i = 0; i < pixels(); ++i) {
            for (size_t c = 0; c < 3; ++c) {
                planes.radiance[c][i] = 1;
                planes.albedo[c][i] = 0.5f;
            }
            planes.normal[2][i] = planes.alpha[i] = 1;
            planes.depth[i] = 3;
            planes.samples[i] = 16;
        }
    }
    size_t pixels() const { return size_t{width} * height; }
    size_t at(uint32_t x, uint32_t y) const { return size_t{y} * width + x; }

    template <typename Change>
    void forAll(Change change) {
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) change(x, y, at(x, y));
    }
    void set(size_t i, float radiance) {
        for (auto& plane : planes.radiance) plane[i] = radiance;
    }
    void setVariance(float variance) {
        for (auto& plane : planes.variance) std::fill(plane.begin(), plane.end(), variance);
    }
    // Normal noise whose variance the frame knows.
    void addNoise(float sigma, unsigned seed = 1) {
        std::mt19937 random(seed);
        std::normal_distribution<float> normal(0, sigma);
        for (auto& plane : planes.radiance)
            for (float& value : plane) value += normal(random);
        setVariance(sigma * sigma);
    }
};

Colour denoised(const Frame& frame, DenoiseSettings settings = {}) {
    Colour out;
    uint32_t next = 0;
    denoise(
        frame.width, frame.height, settings,
        [&](uint32_t first, uint32_t rows, GuidedRows& into) {
            const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
                ASSERT_EQ(to.size(), size_t{rows} * frame.width);
                std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(frame.at(0, first)), to.size(),
                            to.begin());
            };
            for (size_t c = 0; c < 3; ++c) {
                copy(frame.planes.radiance[c], into.radiance[c]);
                copy(frame.planes.variance[c], into.variance[c]);
                copy(frame.planes.albedo[c], into.albedo[c]);
                copy(frame.planes.normal[c], into.normal[c]);
            }
            copy(frame.planes.depth, into.depth);
            copy(frame.planes.alpha, into.alpha);
            copy(frame.planes.samples, into.samples);
        },
        [&](uint32_t first, uint32_t rows, const Colour& radiance) {
            EXPECT_EQ(first, next);
            next = first + rows;
            for (size_t c = 0; c < 3; ++c)
                out[c].insert(out[c].end(), radiance[c].begin(), radiance[c].end());
        });
    EXPECT_EQ(out[0].size(), frame.pixels());
    return out;
}

bool sameBits(const Colour& a, const Colour& b) {
    for (size_t c = 0; c < 3; ++c)
        if (a[c].size() != b[c].size() ||
            std::memcmp(a[c].data(), b[c].data(), a[c].size() * sizeof(float)) != 0)
            return false;
    return true;
}

bool allFinite(const Colour& picture) {
    for (const auto& plane : picture)
        for (const float value : plane)
            if (!std::isfinite(value)) return false;
    return true;
}

// Something to see in every plane: textures, a round body, an outline, noise.
Frame busyFrame(uint32_t width, uint32_t height) {
    Frame frame(width, height);
    frame.forAll([&](uint32_t x, uint32_t y, size_t i) {
        const float u = static_cast<float>(x) * 0.3f, v = static_cast<float>(y) * 0.2f;
        frame.set(i, 1.5f + std::sin(u) * std::cos(v));
        frame.planes.albedo[1][i] = 0.5f + 0.4f * std::sin(u + v);
        frame.planes.normal[0][i] = 0.3f * std::sin(v);
        frame.planes.depth[i] = 2 + 0.05f * v + (x > width / 2 ? 1.f : 0.f);
        frame.planes.alpha[i] = y < height / 4 ? 0.f : 1.f;
    });
    frame.addNoise(0.3f);
    return frame;
}

TEST(Denoise, LeavesTheBitsOfAConstantPicture) {
    Frame frame(50, 40);
    std::fill(frame.planes.radiance[1].begin(), frame.planes.radiance[1].end(), 0.3f);
    frame.setVariance(0.01f);
    EXPECT_TRUE(sameBits(denoised(frame), frame.planes.radiance));
}

TEST(Denoise, LeavesTheBitsOfAPictureWithoutNoise) {
    Frame frame = busyFrame(61, 47);
    frame.setVariance(0);
    EXPECT_TRUE(sameBits(denoised(frame), frame.planes.radiance));
}

// In a window of 17 x 17 pixels at most 289 times; the weights, which see the noise too, leave a fifth of
// that.
TEST(Denoise, ShrinksKnownNoiseOnFlatRegionsAndKeepsTheirMean) {
    constexpr float sigma = 0.2f;
    Frame frame(128, 128);
    frame.addNoise(sigma);
    const Colour result = denoised(frame);
    double sum = 0, rawSum = 0, squares = 0, count = 0;
    frame.forAll([&](uint32_t x, uint32_t y, size_t i) {
        if (x < 10 || y < 10 || x >= 118 || y >= 118) return;
        for (size_t c = 0; c < 3; ++c) {
            sum += result[c][i];
            rawSum += frame.planes.radiance[c][i];
            squares += (double{result[c][i]} - 1) * (double{result[c][i]} - 1);
            count += 1;
        }
    });
    EXPECT_LT(squares / count, sigma * sigma / 60);
    EXPECT_GT(squares / count, sigma * sigma / 400);
    EXPECT_NEAR(sum / rawSum, 1, 0.001);
}

// Means over the columns beside an edge that colour alone does not show through the noise.
std::pair<double, double> besideTheEdge(const Colour& picture, const Frame& frame) {
    double left = 0, right = 0;
    for (uint32_t y = 0; y < frame.height; ++y) {
        left += picture[1][frame.at(frame.width / 2 - 1, y)] / frame.height;
        right += picture[1][frame.at(frame.width / 2, y)] / frame.height;
    }
    return {left, right};
}

Frame edgeFrame(float sigma) {
    Frame frame(64, 200);
    frame.forAll([&](uint32_t x, uint32_t, size_t i) { frame.set(i, x < 32 ? 1.f : 1.3f); });
    frame.addNoise(sigma);
    return frame;
}

TEST(Denoise, KeepsEdgesOfTheNormalSharp) {
    Frame frame = edgeFrame(0.5f);
    const auto [blurredLeft, blurredRight] = besideTheEdge(denoised(frame), frame);
    EXPECT_LT(blurredRight - blurredLeft, 0.2);  // the normals alone make the difference
    frame.forAll([&](uint32_t x, uint32_t, size_t i) {
        if (x < 32) frame.planes.normal[0][i] = 0.8f, frame.planes.normal[2][i] = 0.6f;
    });
    const auto [left, right] = besideTheEdge(denoised(frame), frame);
    EXPECT_NEAR(left, 1, 0.05);
    EXPECT_NEAR(right, 1.3, 0.05);
}

TEST(Denoise, KeepsEdgesOfDepthSharp) {
    Frame frame = edgeFrame(0.5f);
    frame.forAll([&](uint32_t x, uint32_t, size_t i) { frame.planes.depth[i] = x < 32 ? 3.f : 5.f; });
    const auto [left, right] = besideTheEdge(denoised(frame), frame);
    EXPECT_NEAR(left, 1, 0.05);
    EXPECT_NEAR(right, 1.3, 0.05);
}

TEST(Denoise, KeepsTexturesWhileItRemovesTheNoiseOfTheirLight) {
    Frame frame(96, 96);
    const auto albedoAt = [](uint32_t x, uint32_t y) { return (x / 2 + y / 3) % 2 == 0 ? 0.15f : 0.75f; };
    std::mt19937 random(7);
    std::normal_distribution<float> light(1, 0.3f);
    frame.forAll([&](uint32_t x, uint32_t y, size_t i) {
        const float albedo = albedoAt(x, y);
        for (size_t c = 0; c < 3; ++c) {
            frame.planes.albedo[c][i] = albedo;
            frame.planes.radiance[c][i] = albedo * light(random);
            frame.planes.variance[c][i] = 0.09f * albedo * albedo;
        }
    });
    const Colour result = denoised(frame);
    double error = 0, raw = 0;
    frame.forAll([&](uint32_t x, uint32_t y, size_t i) {
        const double truth = albedoAt(x, y);
        error += std::pow((result[0][i] - truth) / truth, 2);
        raw += std::pow((frame.planes.radiance[0][i] - truth) / truth, 2);
    });
    EXPECT_LT(error, raw / 12);
}

TEST(Denoise, AveragesARareBrightSampleAway) {
    Frame frame(48, 48);
    frame.addNoise(0.1f);
    const size_t bright = frame.at(24, 24);
    frame.set(bright, 1000);
    for (auto& plane : frame.planes.variance) plane[bright] = 1e6f;
    const Colour result = denoised(frame);
    EXPECT_LT(result[1][bright], 50);
    for (const float value : result[1]) EXPECT_LT(value, 200);
}

TEST(Denoise, LetsDetailThroughThatTheVarianceSaysIsNone) {
    Frame frame = busyFrame(64, 64);
    for (const float sigma : {0.1f, 0.01f, 0.001f}) {
        Frame less = frame;
        less.setVariance(sigma * sigma);
        const Colour result = denoised(less);
        double change = 0;
        less.forAll([&](uint32_t, uint32_t, size_t i) {
            change += std::pow(double{result[0][i]} - less.planes.radiance[0][i], 2);
        });
        // Of a picture whose neighbours differ by 0.3, no more than a few times what is said to be noise.
        EXPECT_LT(std::sqrt(change / static_cast<double>(less.pixels())), 3 * sigma) << sigma;
    }
}

TEST(Denoise, ScalesWithThePicture) {
    const Frame frame = busyFrame(40, 40);
    const Colour usual = denoised(frame);
    for (const int power : {-20, -3, 20}) {
        Frame scaled = frame;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < frame.pixels(); ++i) {
                scaled.planes.radiance[c][i] = std::ldexp(frame.planes.radiance[c][i], power);
                scaled.planes.variance[c][i] = std::ldexp(frame.planes.variance[c][i], 2 * power);
            }
        Colour result = denoised(scaled);
        for (auto& plane : result)
            for (float& value : plane) value = std::ldexp(value, -power);
        EXPECT_TRUE(sameBits(result, usual)) << power;
    }
}

TEST(Denoise, BandsAndThreadsChangeNoBit) {
    for (const bool wrap : {false, true}) {
        const Frame frame = busyFrame(150, 41);
        const Colour whole = denoised(frame, {.wrap = wrap, .bandRows = 1000, .threads = 1});
        for (const uint32_t rows : {1u, 7u, 40u})
            EXPECT_TRUE(sameBits(denoised(frame, {.wrap = wrap, .bandRows = rows, .threads = 4}), whole))
                << rows;
    }
}

TEST(Denoise, APanoramasEdgesMeet) {
    const Frame frame = busyFrame(72, 30);
    constexpr uint32_t shift = 25;
    const auto turned = [&](const std::vector<float>& plane) {
        std::vector<float> out(plane.size());
        for (uint32_t y = 0; y < frame.height; ++y)
            for (uint32_t x = 0; x < frame.width; ++x)
                out[frame.at((x + shift) % frame.width, y)] = plane[frame.at(x, y)];
        return out;
    };
    Frame other = frame;
    for (auto* planes :
         {&other.planes.radiance, &other.planes.variance, &other.planes.albedo, &other.planes.normal})
        for (auto& plane : *planes) plane = turned(plane);
    for (auto* plane : {&other.planes.depth, &other.planes.alpha, &other.planes.samples})
        *plane = turned(*plane);
    Colour usual = denoised(frame, {.wrap = true});
    EXPECT_FALSE(sameBits(denoised(frame), usual));
    for (auto& plane : usual) plane = turned(plane);
    EXPECT_TRUE(sameBits(denoised(other, {.wrap = true}), usual));
}

TEST(Denoise, TakesTheSpreadOfNeighboursWhereNoVarianceWasMeasured) {
    Frame frame(64, 64);
    frame.addNoise(0.2f);
    frame.setVariance(0);
    std::fill(frame.planes.samples.begin(), frame.planes.samples.end(), 1.f);
    const Colour result = denoised(frame);
    double error = 0;
    for (const float value : result[0])
        error += (value - 1.0) * (value - 1.0) / static_cast<double>(frame.pixels());
    EXPECT_LT(error, 0.04 / 5);
}

TEST(Denoise, AnySizeWillDo) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 70u}, {130u, 3u}})
        for (const bool wrap : {false, true}) {
            Frame frame = busyFrame(width, height);
            EXPECT_TRUE(allFinite(denoised(frame, {.wrap = wrap, .bandRows = 5}))) << width << "x" << height;
        }
}

TEST(Denoise, ExtremesStayFinite) {
    constexpr float values[] = {0, 1e-45f, 1e-6f, 1e6f, 1e15f, 1e19f, std::numeric_limits<float>::max()};
    constexpr float variances[] = {0, 1e-30f, 1e12f, 1e38f, std::numeric_limits<float>::infinity()};
    Frame frame(48, 48);
    std::mt19937 random(3);
    frame.forAll([&](uint32_t, uint32_t, size_t i) {
        frame.set(i, values[random() % std::size(values)]);
        for (auto& plane : frame.planes.variance) plane[i] = variances[random() % std::size(variances)];
        frame.planes.depth[i] = values[random() % std::size(values)];
        frame.planes.alpha[i] = static_cast<float>(random() % 3) / 2;
        frame.planes.samples[i] = static_cast<float>(random() % 3);
        for (auto& plane : frame.planes.albedo) plane[i] = static_cast<float>(random() % 2);
    });
    EXPECT_TRUE(allFinite(denoised(frame)));
}

TEST(Denoise, WhatIsNoNumberDoesNotSpread) {
    Frame frame = busyFrame(40, 40);
    const size_t bad = frame.at(20, 20);
    frame.planes.radiance[0][bad] = frame.planes.variance[1][bad] = frame.planes.normal[0][bad] =
        std::numeric_limits<float>::quiet_NaN();
    Colour result = denoised(frame);
    EXPECT_TRUE(std::isnan(result[0][bad]));  // a file's fault is not hidden
    result[0][bad] = 0;
    EXPECT_TRUE(allFinite(result));
}

TEST(Denoise, RefusesSettingsOutOfRange) {
    const Frame frame(4, 4);
    EXPECT_THAT(errorOf([&] { denoised(frame, {.radius = 0}); }).what(), HasSubstr("radius is 0"));
    EXPECT_THAT(errorOf([&] { denoised(frame, {.radius = 17}); }).what(), HasSubstr("1 … 16"));
    EXPECT_THAT(errorOf([&] { denoised(frame, {.guideTolerance = NAN}); }).what(),
                HasSubstr("guideTolerance"));
    EXPECT_EQ(codeOf([&] { denoised(frame, {.bandRows = 0}); }), ErrorCode::invalidArgument);
}

TEST(Denoise, SaysWhatItDid) {
    EXPECT_EQ(denoiserText({}),
              "joint-nlm 1; radius 8; noiseTolerance 0.6; guideTolerance 1; featureTolerance 0.8");
    EXPECT_THAT(denoiserText({.wrap = true}), HasSubstr("; wrap"));
}

}  // namespace
}  // namespace tilefarm
