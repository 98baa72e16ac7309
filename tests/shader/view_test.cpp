// Cameras, lenses, pixel filters, moving pictures and samplers against closed forms and averages of stills.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/render/sample_parameters.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class ViewTest : public DeviceTest {
protected:
    std::vector<PassPixel> pixels(Renderer& renderer, uint32_t samples, int32_t frame = 0) {
        return renderer.render(frame, std::vector<uint32_t>{0}, {0, samples}).front().pixels;
    }
};

/// Radiance 1 from everything left of x = edge in the plane z = 0.
Scene glowingUpTo(double edge) {
    Scene scene;
    addMesh(scene, quadMesh({0, -1000, 0}, {1000, 0, 0}, {0, 2000, 0}), matte(glm::vec3(0), glm::vec3(1)),
            glm::translate(glm::dmat4(1), glm::dvec3(edge - 1000, 0, 0)));
    return scene;
}

/// A picture one pixel wide and a metre a pixel, whose middle is x = 0.
ImageSpec column() {
    ImageSpec image;
    image.width = 1;
    image.height = image.tileSize = 64;
    return image;
}
Camera flatCamera() {
    Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 1);
    camera.orthographic = true;
    camera.ymag = 32;
    return camera;
}

/// The room of the Cornell kind: a cube lit by a square, with a block that may stand anywhere.
Scene room(double blockX = 0.3) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}));
    addMesh(scene, cubeMesh(false), matte({0.2f, 0.5f, 0.7f}),
            glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(blockX, -0.7, -0.2)), glm::dvec3(0.3)));
    addMesh(scene, quadMesh({-0.3f, 0.99f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}),
            matte(glm::vec3(0), glm::vec3(8)));
    return scene;
}
Camera roomCamera() {
    return cameraAt({-0.5, 0, 0.95}, {0, -0.3, 0}, 1.2);
}

double meanOf(const std::vector<PassPixel>& pixels) {
    double sum = 0;
    for (const PassPixel& p : pixels) sum += p.mean[0];
    return sum / static_cast<double>(pixels.size());
}

// ---- pixel filters

struct FilterCase {
    std::string name;
    PixelFilter filter;
    double radius;
    double (*cdf)(double);  // of the offset over the radius
};
double boxCdf(double x) {
    return (x + 1) / 2;
}
double tentCdf(double x) {
    return x < 0 ? (1 + x) * (1 + x) / 2 : 1 - (1 - x) * (1 - x) / 2;
}
/// Of a Gaussian over the disk of 3σ, seen from the side: a quadrature over the disk's chords.
double gaussianCdf(double x) {
    constexpr int n = 2000;
    double below = 0, all = 0;
    for (int i = 0; i < n; ++i) {
        const double at = -1 + (i + 0.5) * 2 / n;
        const double density = std::exp(-4.5 * at * at) * std::erf(std::sqrt(4.5 * (1 - at * at)));
        all += density;
        below += density * std::clamp((x - (at - 1.0 / n)) * n / 2, 0.0, 1.0);
    }
    return below / all;
}
double blackmanHarrisCdf(double x) {
    const double a = pi * x;
    return 0.5 + 0.5 * x +
           (0.48829 * std::sin(a) + 0.14128 / 2 * std::sin(2 * a) + 0.01168 / 3 * std::sin(3 * a)) /
               (2 * pi * 0.35875);
}

class FilterTest : public ViewTest, public testing::WithParamInterface<FilterCase> {};

// An edge that moves over the pixel counts the samples left of it, so the steps between are a histogram of
// offsets.
TEST_P(FilterTest, OffsetsHaveTheFiltersDistribution) {
    constexpr int kBins = 16;
    constexpr uint32_t kSamples = 256;
    RenderSettings settings = bounces(0);
    settings.filter = GetParam().filter;
    settings.filterRadius = GetParam().radius;
    const double radius = filterRadiusOf(settings);
    Renderer renderer(device, glowingUpTo(-radius), flatCamera(), column(), settings);
    double before = 0, chiSquared = 0;
    int counted = 0;
    const double n = 64.0 * kSamples;
    for (int i = 1; i <= kBins; ++i) {
        const double share = -1 + 2.0 * i / kBins;
        const Scene scene = glowingUpTo(radius * share + 1e-6);
        renderer.setScenes(1, [&](uint32_t) -> const Scene& { return scene; });
        const double below = meanOf(pixels(renderer, kSamples)) * n;
        const double expected = n * (GetParam().cdf(share) - GetParam().cdf(share - 2.0 / kBins));
        if (expected > 5) {
            chiSquared += (below - before - expected) * (below - before - expected) / expected;
            ++counted;
        }
        before = below;
    }
    EXPECT_NEAR(before, n, 0.5) << "all within the radius";
    // 99.9 % of χ² lies below this for up to 15 degrees of freedom, less for fewer bins.
    EXPECT_LT(chiSquared, 37.7) << counted << " bins";
    EXPECT_GE(counted, 8);
}

INSTANTIATE_TEST_SUITE_P(Every, FilterTest,
                         testing::Values(FilterCase{"Pixel", PixelFilter::box, 0, boxCdf},
                                         FilterCase{"WideBox", PixelFilter::box, 1.25, boxCdf},
                                         FilterCase{"Tent", PixelFilter::tent, 0, tentCdf},
                                         FilterCase{"Gaussian", PixelFilter::gaussian, 0, gaussianCdf},
                                         FilterCase{"BlackmanHarris", PixelFilter::blackmanHarris, 2,
                                                    blackmanHarrisCdf}),
                         [](const auto& one) { return one.param.name; });

TEST_F(ViewTest, WithoutJitterEverySampleGoesThroughThePixelsCentre) {
    RenderSettings settings = bounces(0);
    settings.jitter = false;
    Renderer left(device, glowingUpTo(-0.01), flatCamera(), column(), settings);
    EXPECT_EQ(meanOf(pixels(left, 16)), 0);
    Renderer right(device, glowingUpTo(0.01), flatCamera(), column(), settings);
    EXPECT_EQ(meanOf(pixels(right, 16)), 1);
}

// ---- lenses and kinds of cameras

/// Share of the lens from which the picture's middle sees x < 0 beyond the focus, by the lens' own
/// distribution.
TEST_F(ViewTest, BlurOfAnEdgeIsTheShapeOfTheLens) {
    // From 5 m, in focus at 2.5 m: a ray through lens point l meets z = 0 at x = l (1 - 5 / 2.5) = -l.
    Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 1e-4);
    camera.apertureRadius = 0.5f;
    camera.focusDistance = 2.5f;
    for (const uint32_t blades : {0u, 4u}) {
        camera.blades = blades;
        camera.bladeRotation = static_cast<float>(pi / 4);  // a square along the axes
        Renderer renderer(device, glowingUpTo(0), camera, column(), bounces(0));
        const double halfSide = 0.5 / std::sqrt(2.0);
        for (const double edge : {-0.4, -0.2, 0.1, 0.3}) {
            const Scene scene = glowingUpTo(edge);
            renderer.setScenes(1, [&](uint32_t) -> const Scene& { return scene; });
            const double u = edge / 0.5;
            const double disk = 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / pi;
            const double square = std::clamp(0.5 + edge / (2 * halfSide), 0.0, 1.0);
            const double expected = blades == 0 ? disk : square, n = 64.0 * 256;
            EXPECT_NEAR(meanOf(pixels(renderer, 256)), expected,
                        4 * std::sqrt(expected * (1 - expected) / n) + 1e-4)
                << blades << " blades, edge at " << edge;
        }
    }
}

TEST_F(ViewTest, WhatIsInFocusIsSharpAndATinyApertureIsAPinhole) {
    Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 1e-4);
    camera.apertureRadius = 0.5f;
    camera.focusDistance = 5;
    Renderer sharp(device, glowingUpTo(0.01), camera, column(), bounces(0));
    EXPECT_EQ(meanOf(pixels(sharp, 64)), 1);

    Camera pinhole = roomCamera(), tiny = pinhole;
    tiny.apertureRadius = 1e-9f;
    tiny.focusDistance = 1;
    Renderer a(device, room(), pinhole, square(16, 16), bounces(3)),
        b(device, room(), tiny, square(16, 16), bounces(3));
    EXPECT_NEAR(meanOf(pixels(a, 16)), meanOf(pixels(b, 16)), 1e-4);
}

TEST_F(ViewTest, ExtremeFieldsOfViewAndNearFocusStayFinite) {
    for (const double degrees : {0.05, 179.0}) {
        Camera camera = roomCamera();
        camera.yfov = static_cast<float>(degrees * pi / 180);
        camera.apertureRadius = 0.01f;
        camera.focusDistance = 1e-3f;
        Renderer renderer(device, room(), camera, square(16, 16), bounces(3));
        EXPECT_TRUE(std::isfinite(meanOf(pixels(renderer, 16))));
        EXPECT_EQ(renderer.stats().droppedSamples, 0u);
    }
}

TEST_F(ViewTest, APanoramaSeesAllDirectionsOnce) {
    // Half the sphere glows: that of x < 0. The left half of the picture is what lies left of forward (-z).
    Scene scene = glowingUpTo(0);
    Camera camera = cameraAt({-0.5, 0, 0.001}, {-0.5, 0, -1}, 1);
    camera.panorama = true;
    ImageSpec image;
    image.width = 32;
    image.height = 16;
    image.tileSize = 32;
    Renderer renderer(device, scene, camera, image, bounces(0));
    const auto picture = pixels(renderer, 64);
    // The quad is just in front and faces back: seen by the directions with z < 0, the picture's middle half.
    double inside = 0, outside = 0;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const bool front = x >= 8 && x < 24;
            (front ? inside : outside) += picture[y * 32 + x].mean[0] / 256;
        }
    EXPECT_EQ(outside, 0);
    EXPECT_NEAR(inside, 1, 0.08) << "but for what looks past the quad's right edge and its rims";
}

// ---- moving pictures

TEST_F(ViewTest, AMovingSceneIsTheAverageOfStills) {
    constexpr uint32_t kSteps = 8, kSamples = 256;
    const auto roomAt = [](uint32_t step) { return room(-0.6 + 1.2 * (step + 0.5) / kSteps); };
    Scene now;
    const auto sceneOf = [&](uint32_t step) -> const Scene& { return now = roomAt(step); };
    const Scene first = roomAt(0);
    Renderer blurred(device, first, roomCamera(), square(16, 16), bounces(3));
    blurred.setScenes(kSteps, sceneOf);
    const auto moving = pixels(blurred, kSamples);

    Renderer still(device, first, roomCamera(), square(16, 16), bounces(3, 77));
    std::vector<double> mean(moving.size()), variance(moving.size());
    for (uint32_t step = 0; step < kSteps; ++step) {
        still.setScenes(1, [&](uint32_t) -> const Scene& { return sceneOf(step); });
        const auto picture = pixels(still, kSamples / kSteps, static_cast<int32_t>(step));
        for (size_t i = 0; i < picture.size(); ++i) {
            mean[i] += picture[i].mean[0] / kSteps;
            variance[i] +=
                picture[i].m2[0] / (kSamples / kSteps) / (kSamples / kSteps - 1) / (kSteps * kSteps);
        }
    }
    // Sample variances of few samples have heavy tails: the sum of z² over pixels is judged, not the largest.
    double z = 0, sum = 0, sumVariance = 0;
    for (size_t i = 0; i < moving.size(); ++i) {
        const double own = moving[i].m2[0] / kSamples / (kSamples - 1), d = moving[i].mean[0] - mean[i];
        z += d * d / (own + variance[i] + 1e-12);
        sum += d;
        sumVariance += own + variance[i];
    }
    EXPECT_LT(std::abs(sum), 4 * std::sqrt(sumVariance));
    EXPECT_LT(z / static_cast<double>(moving.size()), 1.4);
}

TEST_F(ViewTest, HowAFrameIsCutDoesNotChangeABitOfAMovingScene) {
    const Scene a = room(-0.3), b = room(0.3);
    const auto sceneOf = [&](uint32_t step) -> const Scene& { return step == 0 ? a : b; };
    const ImageSpec image = square(32, 16);
    Renderer renderer(device, a, roomCamera(), image, bounces(2));
    renderer.setScenes(2, sceneOf);
    const auto together = renderer.render(5, allTiles(image), {8, 8});
    for (const uint32_t tile : {3u, 0u, 2u, 1u}) {
        const auto alone = renderer.render(5, std::vector<uint32_t>{tile}, {8, 8});
        EXPECT_EQ(0, std::memcmp(alone[0].pixels.data(), together[tile].pixels.data(),
                                 alone[0].pixels.size() * sizeof(PassPixel)));
    }
}

TEST_F(ViewTest, AMovingCameraIsTheAverageOfStillOnes) {
    // A quarter turn around the block in two keys; stills stand on the circle itself.
    const glm::dvec3 pivot(0.3, -0.7, -0.2);
    const auto turned = [&](double share) {
        Camera camera = roomCamera();
        camera.toWorld = glm::translate(glm::dmat4(1), pivot) *
                         glm::rotate(glm::dmat4(1), share * pi / 4, glm::dvec3(0, 1, 0)) *
                         glm::translate(glm::dmat4(1), -pivot) * camera.toWorld;
        return camera;
    };
    constexpr uint32_t kStills = 64, kSamples = 1024;
    const Scene scene = room();
    Renderer moving(device, scene, CameraPath{{turned(0), turned(1)}, pivot}, square(8, 8), bounces(2));
    const auto blurred = pixels(moving, kSamples);
    Renderer still(device, scene, turned(0), square(8, 8), bounces(2, 5));
    std::vector<double> mean(blurred.size());
    for (uint32_t i = 0; i < kStills; ++i) {
        still.setCamera({{turned((i + 0.5) / kStills)}, std::nullopt});
        const auto picture = pixels(still, kSamples / kStills, static_cast<int32_t>(i));
        for (size_t p = 0; p < picture.size(); ++p) mean[p] += picture[p].mean[0] / kStills;
    }
    double z = 0, sum = 0, sumVariance = 0;
    for (size_t p = 0; p < blurred.size(); ++p) {
        const double own = blurred[p].m2[0] / kSamples / (kSamples - 1), d = blurred[p].mean[0] - mean[p];
        z += d * d / (2 * own);  // the stills' is at most as large
        sum += d;
        sumVariance += 2 * own;
    }
    EXPECT_LT(std::abs(sum), 4 * std::sqrt(sumVariance));
    EXPECT_LT(z / static_cast<double>(blurred.size()), 1.7);
}

TEST(ShutterStep, CoversTheShutterEvenlyAndFavoursNoMoment) {
    for (uint32_t first = 0; first < 64; first += 8) {
        std::vector<int> seen(8);
        for (uint32_t i = 0; i < 8; ++i) ++seen[shutterStep(first + i, 8, 3, 9)];
        EXPECT_EQ(seen, std::vector<int>(8, 1));
    }
    std::vector<int> ofFirst(8);
    for (int32_t frame = 0; frame < 8000; ++frame) ++ofFirst[shutterStep(0, 8, 3, frame)];
    double chiSquared = 0;
    for (const int count : ofFirst) chiSquared += (count - 1000.0) * (count - 1000.0) / 1000;
    EXPECT_LT(chiSquared, 24.3);  // 99.9 % at 7 degrees of freedom
}

// ---- samplers

class SamplerTest : public ViewTest, public testing::WithParamInterface<Sampler> {};

TEST_P(SamplerTest, KeepsTheMeanAndLowersTheError) {
    RenderSettings settings = bounces(2);
    constexpr uint32_t kSamples = 64, kReference = 8192;
    Renderer reference(device, room(), roomCamera(), square(16, 16), bounces(2, 99));
    const auto exact = pixels(reference, kReference);
    const auto errorOf = [&](Sampler sampler, double& bias, double& sigma) {
        settings.sampler = sampler;
        Renderer renderer(device, room(), roomCamera(), square(16, 16), settings);
        const auto picture = pixels(renderer, kSamples);
        double error = 0, variance = 0;
        bias = 0;
        for (size_t i = 0; i < picture.size(); ++i) {
            const double d = picture[i].mean[0] - exact[i].mean[0];
            error += d * d / (double(exact[i].mean[0]) * exact[i].mean[0] + 1e-4);
            bias += d;
            variance +=
                picture[i].m2[0] / kSamples / (kSamples - 1) + exact[i].m2[0] / kReference / (kReference - 1);
        }
        sigma = std::sqrt(variance);
        return error / static_cast<double>(picture.size());
    };
    double bias = 0, sigma = 0, unused = 0, unusedToo = 0;
    const double random = errorOf(Sampler::random, unused, unusedToo);
    const double chosen = errorOf(GetParam(), bias, sigma);
    EXPECT_LT(std::abs(bias), 4 * sigma);  // σ of independent samples: more than these have
    RecordProperty("relMSE_gain", std::to_string(random / chosen));
    EXPECT_LT(chosen, 0.8 * random) << "relMSE " << chosen << " against " << random;
}

INSTANTIATE_TEST_SUITE_P(Both, SamplerTest, testing::Values(Sampler::stratified, Sampler::sobol),
                         [](const auto& one) {
                             return one.param == Sampler::sobol ? "Sobol" : "Stratified";
                         });

}  // namespace
}  // namespace tilefarm
