// How paths go on, end and are bounded: rules without bias agree with each other, biased ones do what they
// say and report it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

glm::dmat4 placed(const glm::dvec3& at, double size) {
    return glm::scale(glm::translate(glm::dmat4(1), at), glm::dvec3(size));
}

Material surface(const glm::vec3& color, float metallic, float roughness) {
    Material m;
    m.baseColor = color;
    m.metallic = metallic;
    m.roughness = roughness;
    return m;
}

/// A white room with a lamp, and in it plastic, brushed metal, a mirror, coated paint, clear and frosted
/// glass.
Scene room() {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}));
    addMesh(scene, quadMesh({-0.6f, 0.99f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1.2f}),
            matte(glm::vec3(0), glm::vec3(4)));
    addMesh(scene, sphereMesh(16), surface({0.8f, 0.2f, 0.2f}, 0, 0.5f), placed({-0.6, -0.7, -0.4}, 0.3));
    addMesh(scene, sphereMesh(16), surface({0.9f, 0.8f, 0.5f}, 1, 0.6f), placed({0, -0.7, -0.5}, 0.3));
    addMesh(scene, sphereMesh(16), surface({0.9f, 0.9f, 0.9f}, 1, 0), placed({0.6, -0.7, -0.4}, 0.3));
    Material coated = surface({0.1f, 0.3f, 0.6f}, 0, 0.7f);
    coated.clearcoat = 1;
    addMesh(scene, sphereMesh(16), coated, placed({-0.5, -0.75, 0.3}, 0.25));
    Material glass = surface({1, 1, 1}, 0, 0);
    glass.transmission = glass.thickness = 1;
    addMesh(scene, sphereMesh(16), glass, placed({0, -0.75, 0.3}, 0.25));
    glass.roughness = 0.6f;
    addMesh(scene, sphereMesh(16), glass, placed({0.5, -0.75, 0.3}, 0.25));
    return scene;
}

/// Inside a sphere that glows with radiance 1 and reflects `albedo`.
Scene furnace(float albedo) {
    Scene scene;
    Material wall = matte(glm::vec3(albedo), glm::vec3(1));
    wall.doubleSided = true;
    addMesh(scene, cubeMesh(true), wall);
    return scene;
}

/// Paths of known light: no random ends, every light found by the paths themselves.
RenderSettings countedBounces(uint32_t count) {
    RenderSettings settings = bounces(count);
    settings.directLight = DirectLight::bsdf;
    settings.roulette = RouletteRule::none;
    return settings;
}

class PathRulesTest : public DeviceTest {
protected:
    /// The room under two settings: the same picture, by z-tests of four regions and three channels.
    void expectSamePicture(const std::function<void(RenderSettings&)>& change, uint32_t samples) {
        const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
        RenderSettings other = bounces(4, 2);
        change(other);
        static const auto usual = renderFrame(device, room(), camera, square(32), bounces(4, 1), 256);
        const auto changed = renderFrame(device, room(), camera, square(32), other, samples);
        for (const size_t corner : {0, 16, 512, 528})
            for (const int channel : {0, 1, 2})
                expectSame(meanOf(quarter(usual, corner), channel), meanOf(quarter(changed, corner), channel),
                           1e-4);
    }

    static std::vector<FilmPixel> quarter(const std::vector<FilmPixel>& frame, size_t corner) {
        std::vector<FilmPixel> pixels;
        for (size_t y = 0; y < 16; ++y)
            for (size_t x = 0; x < 16; ++x) pixels.push_back(frame[corner + 32 * y + x]);
        return pixels;
    }

    /// One tile of 32 x 32 pixels.
    PassFilm render(const Scene& scene, const Camera& camera, const RenderSettings& settings,
                    uint32_t samples) {
        Renderer renderer(device, scene, camera, square(32), settings);
        return renderer.render(0, std::vector<uint32_t>{0}, {0, samples}).front();
    }
};

TEST_F(PathRulesTest, DirectionsByTheCosineShowTheSamePicture) {
    expectSamePicture([](RenderSettings& s) { s.directionSampling = DirectionSampling::cosine; }, 512);
}

TEST_F(PathRulesTest, UniformDirectionsShowTheSamePicture) {
    expectSamePicture([](RenderSettings& s) { s.directionSampling = DirectionSampling::uniform; }, 1024);
}

TEST_F(PathRulesTest, DirectionsOfOneStrategyAloneShowTheSamePicture) {
    expectSamePicture(
        [](RenderSettings& s) {
            s.directionSampling = DirectionSampling::cosine;
            s.directLight = DirectLight::bsdf;
        },
        1024);
}

TEST_F(PathRulesTest, RouletteOfOneProbabilityShowsTheSamePicture) {
    expectSamePicture(
        [](RenderSettings& s) {
            s.roulette = RouletteRule::constant;
            s.rouletteStart = 1;
            s.rouletteSurvival = 0.7;
        },
        512);
}

TEST_F(PathRulesTest, PathsWithoutRouletteShowTheSamePicture) {
    expectSamePicture([](RenderSettings& s) { s.roulette = RouletteRule::none; }, 256);
}

TEST_F(PathRulesTest, UniformDirectionsAreTheNoisiest) {
    const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    const auto noise = [&](DirectionSampling sampling) {
        RenderSettings settings = bounces(4);
        settings.directionSampling = sampling;
        return meanOf(renderFrame(device, room(), camera, square(32), settings, 128)).sigma;
    };
    const double cosine = noise(DirectionSampling::cosine);
    EXPECT_LT(noise(DirectionSampling::bsdf), cosine);
    EXPECT_LT(cosine, noise(DirectionSampling::uniform));
}

TEST_F(PathRulesTest, ClampsBoundWhatASampleGathersAtOnce) {
    // Light that scattered b times is 0.5^b.
    RenderSettings settings = countedBounces(3);
    settings.clampDirect = 0.4;
    settings.clampIndirect = 0.2;
    const PassFilm film = render(furnace(0.5f), cameraAt({0, 0, 0}, {0, 0, 1}, 1), settings, 8);
    for (const PassPixel& pixel : film.pixels) EXPECT_NEAR(pixel.mean[0], 1 + 0.4 + 0.2 + 0.125, 1e-5);
    EXPECT_EQ(film.faults.clampedSamples, 8u * 32 * 32);
    EXPECT_NEAR(film.faults.clampedLuminance / (8.0 * 32 * 32), 0.1 + 0.05, 1e-4)
        << "what it took away is reported";
}

TEST_F(PathRulesTest, ClampsAboveEveryLightChangeNothing) {
    const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    RenderSettings settings = bounces(4);
    const PassFilm plain = render(room(), camera, settings, 8);
    settings.clampDirect = settings.clampIndirect = 1e20;
    const PassFilm bounded = render(room(), camera, settings, 8);
    EXPECT_EQ(
        std::memcmp(plain.pixels.data(), bounded.pixels.data(), plain.pixels.size() * sizeof(PassPixel)), 0);
    EXPECT_EQ(bounded.faults.clampedSamples, 0u);
}

TEST_F(PathRulesTest, TruncatedPathsReportWhatTheyCarried) {
    const PassFilm film = render(furnace(0.5f), cameraAt({0, 0, 0}, {0, 0, 1}, 1), countedBounces(3), 8);
    EXPECT_EQ(film.faults.truncatedPaths, 8u * 32 * 32);
    EXPECT_NEAR(film.faults.truncatedThroughput, 8 * 32 * 32 * 0.125, 1e-2);
}

TEST_F(PathRulesTest, ReportsRepeatToTheBitWhateverTheTiles) {
    const Scene scene = room();
    const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    RenderSettings settings = bounces(3);
    settings.clampDirect = settings.clampIndirect = 0.3;
    const auto stats = [&](uint32_t tile, std::vector<uint32_t> passes) {
        const ImageSpec image = square(64, tile);
        Renderer renderer(device, scene, camera, image, settings);
        uint32_t first = 0;
        for (const uint32_t count : passes) {
            renderer.render(0, allTiles(image), {first, count});
            first += count;
        }
        return renderer.stats();
    };
    const RenderStats once = stats(64, {8});
    EXPECT_GT(once.faults.truncatedThroughput, 0);
    EXPECT_GT(once.faults.clampedLuminance, 0);
    for (const uint32_t tile : {64u, 32u, 8u}) {
        const RenderStats again = stats(tile, {1, 3, 4});
        EXPECT_EQ(again.faults, once.faults) << tile;
        EXPECT_EQ(again.rays, once.rays) << tile;
    }
}

/// A floor of albedo 1/2 under a lamp of 1 W/sr at height 2, which a large board at height 1 hides.
Scene shadowed(bool withBoard) {
    Scene scene;
    addMesh(scene, quadMesh({-5, 0, 6}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
    if (withBoard) addMesh(scene, quadMesh({-2, 1, -2}, {4, 0, 0}, {0, 0, 4}), matte(glm::vec3(0)));
    PunctualLight lamp;
    lamp.position = {0, 2, 0};
    scene.lights.push_back(lamp);
    return scene;
}

TEST_F(PathRulesTest, LightsShineThroughEverythingFromTheShadowDepthOn) {
    const Camera camera = cameraAt({0.1, 0.5, 0.1}, {0, 0, 0}, 1e-3);
    RenderSettings settings = bounces(1);
    const double lit = 0.5 / pi / 4;
    EXPECT_EQ(render(shadowed(true), camera, settings, 4).pixels[0].mean[0], 0.f);
    settings.shadowDepth = 0;
    EXPECT_NEAR(render(shadowed(true), camera, settings, 4).pixels[0].mean[0], lit, 1e-3 * lit);
    EXPECT_NEAR(render(shadowed(false), camera, bounces(1), 4).pixels[0].mean[0], lit, 1e-3 * lit);
}

TEST_F(PathRulesTest, ShadowsBeforeTheShadowDepthAreKept) {
    // One bounce from floor to board, which is black: what the second surface sees does not show.
    const Camera camera = cameraAt({0.1, 0.5, 0.1}, {0, 0, 0}, 1e-3);
    RenderSettings settings = bounces(2);
    settings.shadowDepth = 1;
    EXPECT_EQ(render(shadowed(true), camera, settings, 4).pixels[0].mean[0], 0.f);
}

/// A lamp of some radius and always the same power, a mirror ball, and the floor on which it makes a caustic.
Scene caustic(double radius) {
    Scene scene;
    addMesh(scene, quadMesh({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), matte(glm::vec3(0.5f)));
    addMesh(scene, sphereMesh(48), surface(glm::vec3(1), 1, 0), placed({0, 0.5, 0}, 0.5));
    AreaLight lamp;
    lamp.shape = AreaShape::sphere;
    lamp.position = {2, 1.2, 0};
    lamp.radius = radius;
    lamp.radiance = glm::vec3(1 / (radius * radius));
    scene.areaLights.push_back(lamp);
    return scene;
}

TEST_F(PathRulesTest, RegularisationFindsCausticsOfTinyLamps) {
    // The floor beside the ball, where a lamp of 20 cm still makes the same light on average.
    const Camera camera = cameraAt({1, 3, 2}, {0.9, 0, 0}, 0.3);
    const auto mean = [&](double radius, double regularisation) {
        RenderSettings settings = bounces(3);
        settings.regularisation = regularisation;
        return meanOf(renderFrame(device, caustic(radius), camera, square(32), settings, 512));
    };
    const Mean direct = [&] {
        RenderSettings settings = bounces(1);
        return meanOf(renderFrame(device, caustic(0.2), camera, square(32), settings, 64));
    }();
    const double ofMirror = mean(0.2, 0).value - direct.value;
    EXPECT_GT(ofMirror, 0.02 * direct.value) << "there is a caustic";
    EXPECT_LT(mean(1e-4, 0).value - direct.value, 0.5 * ofMirror) << "that paths to a tiny lamp do not find";
    EXPECT_NEAR(mean(1e-4, 0.1).value - direct.value, ofMirror, 0.25 * ofMirror);
}

TEST_F(PathRulesTest, RegularisationLeavesMirrorsThatTheCameraSees) {
    Scene scene;
    addMesh(scene, cubeMesh(false), surface(glm::vec3(0.9f), 1, 0));
    scene.environment = uniformEnvironment({0.4f, 0.5f, 0.7f});
    const Camera camera = cameraAt({2, 1.5, 3}, {0, 0, 0}, 0.8);
    RenderSettings settings = bounces(4);
    const PassFilm plain = render(scene, camera, settings, 4);
    settings.regularisation = 0.3;
    const PassFilm regular = render(scene, camera, settings, 4);
    EXPECT_EQ(
        std::memcmp(plain.pixels.data(), regular.pixels.data(), plain.pixels.size() * sizeof(PassPixel)), 0);
}

TEST_F(PathRulesTest, RegularisationKeepsTheEnergyOfAWhiteRoom) {
    Scene scene;
    addMesh(scene, quadMesh({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}), matte(glm::vec3(1)));
    addMesh(scene, cubeMesh(false), surface(glm::vec3(1), 1, 0), placed({0, -0.4, 0}, 0.5));
    scene.environment = uniformEnvironment(glm::vec3(1));
    RenderSettings settings = bounces(64);
    settings.regularisation = 0.2;
    // Compensation keeps rough metals within half a per cent of white.
    expectMean(
        meanOf(renderFrame(device, scene, cameraAt({0, 1, 4}, {0, -0.3, 0}, 0.7), square(32), settings, 256)),
        1, 5e-3);
}

}  // namespace
}  // namespace tilefarm
