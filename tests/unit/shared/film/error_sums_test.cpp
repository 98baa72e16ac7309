#include "shared/film/error_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "shared/film/notices.h"
#include "shared/film/pixel_error.h"

namespace tilefarm {
namespace {

constexpr uint32_t kSide = 48, kSamples = 64;

/// What samples of a pixel are drawn from.
struct Light {
    double base = 0, noise = 0;        // normal
    double rare = 0, probability = 0;  // and now and then so much more
    double mean() const { return base + rare * probability; }
    double variance() const { return noise * noise + rare * rare * probability * (1 - probability); }
};
using Scene = std::function<Light(uint32_t x, uint32_t y)>;

FilmTile render(const Scene& scene, unsigned seed, const Rect& rect = {0, 0, kSide, kSide}) {
    FilmTile tile(rect);
    for (uint32_t i = 0; i < rect.area(); ++i) {
        const uint32_t x = rect.x + i % rect.width, y = rect.y + i / rect.width;
        const Light light = scene(x, y);
        std::mt19937 random(seed * 1000003 + y * kSide + x);
        std::normal_distribution<double> normal;
        std::bernoulli_distribution found(light.probability);
        FilmPixel& pixel = tile.pixels[i];
        double mean = 0;
        for (uint32_t n = 1; n <= kSamples; ++n) {
            const double sample =
                light.base + light.noise * normal(random) + (found(random) ? light.rare : 0);
            const double step = sample - mean;
            mean += step / n;
            pixel.m2Luminance += step * (sample - mean);
        }
        pixel.mean = {mean, mean, mean};
        pixel.count = kSamples;
    }
    return tile;
}

/// Root of the mean expected squared relative error, and of the error that this picture has.
struct Truth {
    double expected = 0, actual = 0;
};
Truth truthOf(const Scene& scene, const FilmTile& tile) {
    Truth truth;
    for (uint32_t i = 0; i < tile.rect.area(); ++i) {
        const Light light = scene(i % kSide, i / kSide);
        const double scale = (light.mean() * light.mean() + 1e-4) * static_cast<double>(tile.rect.area());
        const double step = tile.pixels[i].luminance() - light.mean();
        truth.expected += light.variance() / kSamples / scale;
        truth.actual += step * step / scale;
    }
    return {std::sqrt(truth.expected), std::sqrt(truth.actual)};
}

ErrorSums sumsOf(const FilmTile& tile) {
    ErrorSums sums;
    sums.add(tile);
    return sums;
}

// Over so many seeds, as root of the mean square.
double estimatedOverExpected(const Scene& scene, unsigned seeds = 8) {
    double sum = 0, expected = 0;
    for (unsigned seed = 0; seed < seeds; ++seed) {
        const FilmTile tile = render(scene, seed);
        sum += std::pow(sumsOf(tile).relativeError(), 2) / seeds;
        expected = truthOf(scene, tile).expected;
    }
    return std::sqrt(sum) / expected;
}

// As it was: each pixel's variance over its own luminance.
double ownOverExpected(const Scene& scene) {
    const FilmTile tile = render(scene, 0);
    double sum = 0;
    for (const FilmPixel& pixel : tile.pixels)
        sum += pixel.varianceOfMeanLuminance() / (pixel.luminance() * pixel.luminance() + 1e-4);
    return std::sqrt(sum / static_cast<double>(tile.rect.area())) / truthOf(scene, tile).expected;
}

Light evenLight(uint32_t, uint32_t) {
    return {.base = 0.5, .noise = 1};
}
Light fireflies(uint32_t, uint32_t) {
    return {.base = 0.5, .noise = 0.3, .rare = 200, .probability = 2e-4};
}
Light seldomFound(uint32_t, uint32_t) {
    return {.rare = 10, .probability = 0.01};
}
Light stripes(uint32_t x, uint32_t) {
    return x % 8 < 4 ? Light{.base = 2, .noise = 0.5} : Light{.base = 0.1, .noise = 0.05};
}

TEST(ErrorSums, FollowsItsFormulaWherePixelsHaveNoNeighbours) {
    FilmTile tile(Rect{0, 0, 2, 1});
    for (size_t i = 0; i < 2; ++i) {
        tile.pixels[i].count = 5;
        tile.pixels[i].mean = {1, 1, 1};
        tile.pixels[i].m2Luminance = i == 0 ? 20. * 0.04 : 0.;  // variance of the mean 0.04 and 0
    }
    ErrorSums sums;
    EXPECT_EQ(sums.relativeError(), 0);
    sums.add(tile);
    EXPECT_NEAR(sums.relativeError(), std::sqrt(0.5 * 0.04 / 1.0001), 1e-15);
}

TEST(ErrorSums, GivesTheTrueErrorOfEvenLight) {
    EXPECT_NEAR(estimatedOverExpected(evenLight), 1, 0.05);
}

TEST(ErrorSums, GivesTheTrueErrorWhereRareBrightPathsHideIt) {
    EXPECT_LT(ownOverExpected(fireflies), 0.35) << "their own luminance hides them";
    EXPECT_NEAR(estimatedOverExpected(fireflies), 1, 0.1);
}

TEST(ErrorSums, GivesTheTrueErrorWherePixelsMissTheLight) {
    EXPECT_LT(ownOverExpected(seldomFound), 0.7);
    EXPECT_NEAR(estimatedOverExpected(seldomFound), 1, 0.1);
}

TEST(ErrorSums, DoesNotMixWhatDiffersMoreThanItsNoise) {
    EXPECT_NEAR(estimatedOverExpected(stripes), 1, 0.05);
}

TEST(ErrorSums, TakesLuminanceFromPixelsThatLookAlike) {
    const Scene scene = [](uint32_t x, uint32_t) {
        return x % 2 ? Light{.base = 2, .noise = 0.1} : fireflies(x, 0);
    };
    double sum = 0, expected = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        FilmTile tile = render(scene, seed);
        for (uint32_t i = 0; i < tile.rect.area(); ++i)
            tile.pixels[i].albedo = i % 2 ? std::array{0.8, 0.8, 0.8} : std::array{0.2, 0.2, 0.2};
        sum += sumsOf(tile).relativeVariance / static_cast<double>(tile.rect.area()) / 8;
        expected = truthOf(scene, tile).expected;
    }
    EXPECT_NEAR(std::sqrt(sum) / expected, 1, 0.1);
}

TEST(ErrorSums, DoesNotDependOnTileSizeOrOrder) {
    const ErrorSums whole = sumsOf(render(fireflies, 3));
    ErrorSums parts;
    for (uint32_t y = kSide; y > 0; y -= 8)
        for (uint32_t x = kSide; x > 0; x -= 24)
            parts.add(sumsOf(render(fireflies, 3, {x - 24, y - 8, 24, 8})));
    EXPECT_EQ(parts.pixels, whole.pixels);
    EXPECT_EQ(parts.tail.worst(), whole.tail.worst());
    EXPECT_NEAR(parts.relativeError(), whole.relativeError(), 1e-13 * whole.relativeError());
    EXPECT_NEAR(parts.squares, whole.squares, 1e-13 * whole.squares);
    EXPECT_NEAR(parts.borrowed, whole.borrowed, 1e-13 * whole.borrowed);
}

TEST(ErrorSums, CountsDroppedSamples) {
    FilmTile tile(Rect{0, 0, 4, 4});
    for (FilmPixel& pixel : tile.pixels) pixel.dropped = 2;
    EXPECT_EQ(sumsOf(tile).droppedSamples, 32u);
}

TEST(ErrorSums, GivesAnIntervalThatHoldsTheTruth) {
    for (const auto& scene : {evenLight, fireflies, seldomFound, stripes}) {
        int held = 0;
        for (unsigned seed = 0; seed < 20; ++seed) {
            const FilmTile tile = render(scene, 100 + seed);
            const ErrorEstimate e = sumsOf(tile).estimate();
            const double truth = truthOf(scene, tile).actual;
            held += truth >= e.low && truth <= e.high;
        }
        EXPECT_GE(held, 17);
    }
}

TEST(ErrorSums, NamesThePixelThatDecides) {
    FilmTile tile = render([](uint32_t, uint32_t) { return Light{.base = 0.5, .noise = 0.05}; }, 1);
    FilmPixel& hit = tile.pixels[5 * kSide + 19];
    hit.mean = {100, 100, 100};  // by one sample of 64
    hit.m2Luminance = 100. * 100 * 64 * 63;
    const ErrorEstimate e = sumsOf(tile).estimate();
    ASSERT_FALSE(e.worst.empty());
    EXPECT_EQ(e.worst[0].x, 19u);
    EXPECT_EQ(e.worst[0].y, 5u);
    EXPECT_GT(e.worstShare, 0.99);
    const auto notices = noticesOf(e);
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_NE(notices[0].find("--pixel 19,5"), std::string::npos) << notices[0];
    EXPECT_GT(e.high / e.low, 10) << "what rests on one sample is known badly";

    const ErrorEstimate even = sumsOf(render(evenLight, 1)).estimate();
    EXPECT_TRUE(noticesOf(even).empty());
    EXPECT_LT(even.high / even.low, 1.6);
}

TEST(ErrorSums, StaysFiniteOrSaysSo) {
    FilmTile dark(Rect{0, 0, 16, 16});
    EXPECT_EQ(sumsOf(dark).estimate().relativeError, 0);
    FilmTile tile = render(evenLight, 1);
    tile.pixels[3].m2Luminance = 1. / 0.;  // finite samples whose squares fp32 does not hold
    EXPECT_TRUE(std::isinf(sumsOf(tile).relativeError()));
    EXPECT_EQ(sumsOf(tile).estimate().high, sumsOf(tile).relativeError());
}

}  // namespace
}  // namespace tilefarm
