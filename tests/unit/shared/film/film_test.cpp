#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "shared/film/film.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

using Rgb = std::array<float, 3>;

double luminanceOf(const Rgb& c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

// What a kernel leaves of these samples, computed in two passes in long double.
PassPixel passOf(const std::vector<Rgb>& samples) {
    PassPixel pixel;
    pixel.count = static_cast<float>(samples.size());
    const auto n = static_cast<long double>(samples.size());
    long double lumMean = 0, lumM2 = 0;
    for (const Rgb& s : samples) lumMean += luminanceOf(s) / n;
    for (const Rgb& s : samples) lumM2 += (luminanceOf(s) - lumMean) * (luminanceOf(s) - lumMean);
    pixel.m2Luminance = static_cast<float>(lumM2);
    for (size_t c = 0; c < 3; ++c) {
        long double mean = 0, m2 = 0;
        for (const Rgb& s : samples) mean += s[c] / n;
        for (const Rgb& s : samples) m2 += (s[c] - mean) * (s[c] - mean);
        pixel.mean[c] = static_cast<float>(mean);
        pixel.m2[c] = static_cast<float>(m2);
    }
    return pixel;
}

std::vector<Rgb> randomSamples(size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::lognormal_distribution<float> radiance(0.f, 1.5f);
    std::vector<Rgb> samples(count);
    for (Rgb& s : samples) s = {radiance(random), radiance(random), 0.01f * radiance(random)};
    return samples;
}

TEST(FilmPixel, MergingPassesGivesMeanAndM2OfAllSamples) {
    const auto samples = randomSamples(1000, 1);
    const PassPixel whole = passOf(samples);

    FilmPixel merged;
    for (const SampleRange range : passSchedule(1000)) {
        const std::vector<Rgb> part(samples.begin() + range.first, samples.begin() + range.end());
        merged.merge(passOf(part), range.count);
    }

    // The passes come in fp32: 2^-24 relative each, and as much again from the reference.
    EXPECT_EQ(merged.count, 1000);
    EXPECT_EQ(merged.dropped, 0);
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(merged.mean[c], whole.mean[c], 2e-7 * whole.mean[c]);
        EXPECT_NEAR(merged.m2[c], whole.m2[c], 1e-6 * whole.m2[c]);
    }
    EXPECT_NEAR(merged.m2Luminance, whole.m2Luminance, 1e-6 * whole.m2Luminance);
    EXPECT_NEAR(merged.varianceOfMean(0), whole.m2[0] / (1000. * 999.), 1e-6 * whole.m2[0] / (1000. * 999.));
}

TEST(FilmPixel, AFarMeanDoesNotDrownTheVariance) {
    // 10000 ± 0.5: sum of squares minus square of sum would lose it all in fp32, and nearly all in double.
    FilmPixel pixel;
    for (int i = 0; i < 1000; ++i) {
        PassPixel pass;
        pass.count = 1;
        pass.mean = {i % 2 ? 10000.5f : 9999.5f, 0, 0};
        pixel.merge(pass, 1);
    }
    EXPECT_DOUBLE_EQ(pixel.mean[0], 10000);
    EXPECT_NEAR(pixel.m2[0], 250, 1e-9);
}

TEST(FilmPixel, TheFirstPassIsTakenBitForBit) {
    const PassPixel pass = passOf(randomSamples(7, 3));
    FilmPixel pixel;
    pixel.merge(pass, 7);
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(pixel.mean[c], pass.mean[c]);
        EXPECT_EQ(pixel.m2[c], pass.m2[c]);
    }
    EXPECT_EQ(pixel.m2Luminance, pass.m2Luminance);
}

TEST(FilmPixel, WeighsAuxiliaryChannelsBySamples) {
    PassPixel one, three;
    one.count = 1, one.albedo = {1, 0, 0}, one.normal = {0, 0, 1}, one.depth = 8, one.alpha = 1;
    three.count = 3, three.albedo = {0, 1, 0}, three.depth = 4;
    FilmPixel pixel;
    pixel.merge(one, 1);
    pixel.merge(three, 3);
    EXPECT_DOUBLE_EQ(pixel.albedo[0], 0.25);
    EXPECT_DOUBLE_EQ(pixel.albedo[1], 0.75);
    EXPECT_DOUBLE_EQ(pixel.normal[2], 0.25);
    EXPECT_DOUBLE_EQ(pixel.depth, 5);
    EXPECT_DOUBLE_EQ(pixel.alpha, 0.25);
}

TEST(FilmPixel, CountsDroppedSamplesAndLeavesThemOutOfTheMean) {
    PassPixel pass;
    pass.count = 1, pass.mean = {2, 2, 2};
    FilmPixel pixel;
    pixel.merge(pass, 4);
    pixel.merge(PassPixel{}, 2);  // nothing finite at all
    EXPECT_EQ(pixel.dropped, 5);
    EXPECT_EQ(pixel.count, 1);
    EXPECT_EQ(pixel.mean[0], 2);
}

TEST(FilmPixel, HasNoVarianceFromOneSample) {
    PassPixel pass;
    pass.count = 1, pass.mean = {2, 2, 2};
    FilmPixel pixel;
    EXPECT_EQ(pixel.varianceOfMean(0), 0);
    pixel.merge(pass, 1);
    EXPECT_EQ(pixel.varianceOfMean(0), 0);
    EXPECT_EQ(pixel.varianceOfMeanLuminance(), 0);
}

PassFilm filmOf(Rect rect, SampleRange samples) {
    PassFilm film{3, rect, samples, std::vector<PassPixel>(rect.area())};
    for (PassPixel& pixel : film.pixels) {
        pixel.count = static_cast<float>(samples.count);
        pixel.mean = {1, 1, 1};
    }
    return film;
}

TEST(FilmTile, TakesPassesInSampleOrderOnly) {
    const Rect rect{8, 16, 4, 2};
    FilmTile tile(rect);
    EXPECT_EQ(codeOf([&] { tile.merge(filmOf(rect, {1, 1})); }), ErrorCode::conflict);
    tile.merge(filmOf(rect, {0, 1}));
    EXPECT_EQ(codeOf([&] { tile.merge(filmOf(rect, {0, 1})); }), ErrorCode::conflict);
    tile.merge(filmOf(rect, {1, 3}));
    EXPECT_EQ(tile.mergedSamples, 4u);
    EXPECT_EQ(tile.pixels.back().count, 4);
}

TEST(FilmTile, RefusesAnotherRectangle) {
    FilmTile tile(Rect{0, 0, 4, 2});
    EXPECT_EQ(codeOf([&] { tile.merge(filmOf({0, 0, 2, 4}, {0, 1})); }), ErrorCode::unprocessable);
}

TEST(FilmTile, RefusesWhatNoKernelLeavesAndStaysAsItWas) {
    const Rect rect{8, 16, 4, 2};
    const std::vector<std::pair<const char*, std::function<void(PassPixel&)>>> faults{
        {"NaN mean", [](PassPixel& p) { p.mean[1] = kNaN; }},
        {"infinite mean", [](PassPixel& p) { p.mean[0] = kInf; }},
        {"NaN depth", [](PassPixel& p) { p.depth = kNaN; }},
        {"infinite normal", [](PassPixel& p) { p.normal[2] = -kInf; }},
        {"negative M2", [](PassPixel& p) { p.m2[2] = -1; }},
        {"NaN M2 of luminance", [](PassPixel& p) { p.m2Luminance = kNaN; }},
        {"more samples than the pass", [](PassPixel& p) { p.count = 3; }},
        {"half a sample", [](PassPixel& p) { p.count = 0.5f; }},
        {"negative samples", [](PassPixel& p) { p.count = -1; }},
        {"NaN samples", [](PassPixel& p) { p.count = kNaN; }},
    };
    for (const auto& [name, spoil] : faults) {
        FilmTile tile(rect);
        PassFilm film = filmOf(rect, {0, 2});
        spoil(film.pixels[5]);
        const Error error = errorOf([&] { tile.merge(film); });
        EXPECT_EQ(error.code, ErrorCode::unprocessable) << name;
        EXPECT_NE(std::string(error.what()).find("pixel (9, 17)"), std::string::npos) << error.what();
        EXPECT_EQ(tile.mergedSamples, 0u);
        EXPECT_EQ(tile.pixels[0].count, 0);
    }
    PassFilm overflowed = filmOf(rect, {0, 2});
    overflowed.pixels[0].m2[0] = kInf;  // finite samples whose squares fp32 does not hold
    EXPECT_NO_THROW(FilmTile(rect).merge(overflowed));
}

}  // namespace
}  // namespace tilefarm
