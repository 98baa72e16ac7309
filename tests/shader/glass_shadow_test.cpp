// Lights behind smooth thin-walled glass: shadow rays go straight through it, and so does a path that looks
// for the same light by itself, counted once.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "tests/shader/device_fixture.h"
#include "tests/shader/light_scenes.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class GlassShadowTest : public DeviceTest {};

Material pane(const glm::vec3& tint = glm::vec3(1), float roughness = 0) {
    Material m = matte(tint);
    m.ior = 1.5f;
    m.roughness = roughness;
    m.transmission = 1;
    return m;
}

/// Level, at a height, facing down or up.
Mesh level(float height, float half, bool up = true) {
    const glm::vec3 a(2 * half, 0, 0), b(0, 0, -2 * half), corner(-half, height, half);
    return up ? quadMesh(corner, a, b) : quadMesh(corner, b, a);
}

/// A floor of albedo 0.5 at y = 0.
Scene floorScene() {
    Scene scene;
    addMesh(scene, level(0, 20), matte(glm::vec3(0.5f)));
    return scene;
}

/// Straight down on the floor, from below all panes.
const Camera kOverFloor = cameraAt({0, 0.5, 0}, {0, 0, 0}, 0.001);

/// Of a dielectric of index 1.5, from outside.
double fresnel(double cosine) {
    const double eta = 1.5, inside = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
    const double s = (cosine - eta * inside) / (cosine + eta * inside);
    const double p = (eta * cosine - inside) / (eta * cosine + inside);
    return (s * s + p * p) / 2;
}

PunctualLight sun(const glm::dvec3& direction) {
    PunctualLight light;
    light.type = PunctualType::directional;
    light.direction = glm::normalize(direction);
    light.color = glm::vec3(pi);
    return light;
}

double floorRadiance(const gpu::Device& device, const Scene& scene, RenderSettings settings = bounces(1)) {
    return meanOf(renderFrame(device, scene, kOverFloor, square(2), settings, 4), 1).value;
}

TEST_F(GlassShadowTest, SunlightComesThroughPanesAsTheyTransmitIt) {
    Scene scene = floorScene();
    scene.lights = {sun({0, -1, 0})};
    addMesh(scene, level(1, 30, false), pane({0.25f, 0.5f, 1}));
    const double through = 1 - fresnel(1);
    const auto frame = renderFrame(device, scene, kOverFloor, square(2), bounces(1), 4);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(meanOf(frame, channel).value, 0.5 * through * std::exp2(channel - 2), 1e-5);
    addMesh(scene, level(2, 30), pane());
    EXPECT_NEAR(floorRadiance(device, scene), 0.5 * 0.5 * through * through, 1e-5);
    scene.lights = {sun({std::tan(pi / 3), -1, 0})};  // at 60°
    EXPECT_NEAR(floorRadiance(device, scene), 0.25 * 0.5 * std::pow(1 - fresnel(0.5), 2), 1e-5);
}

TEST_F(GlassShadowTest, LampsAndSpotsShineThroughPanes) {
    Scene scene = floorScene();
    PunctualLight lamp;
    lamp.position = {0, 2, 0};
    lamp.color = glm::vec3(4 * pi);
    PunctualLight spot = lamp;
    spot.type = PunctualType::spot;
    spot.direction = {0, -1, 0};
    spot.innerCone = 0.5f;
    scene.lights = {lamp, spot};
    addMesh(scene, level(1, 30), pane());
    RenderSettings settings = bounces(1);
    settings.lightSelection = LightSelection::all;
    EXPECT_NEAR(floorRadiance(device, scene, settings), 2 * 0.5 * (1 - fresnel(1)), 1e-5);
    scene.lights = {lamp};
    scene.lights[0].position = {0, 0.9, 0};  // below the pane
    EXPECT_NEAR(floorRadiance(device, scene), 0.5 * 4 / 0.81, 1e-4);
}

TEST_F(GlassShadowTest, WhatIsNotSmoothThinGlassStaysInTheWay) {
    Material solid = pane(), half = pane(), metal = pane();
    solid.thickness = 1;
    half.transmission = 0.5f;
    metal.metallic = 1;
    // Rough: a path finds the light at the glass itself.
    const Material roofs[] = {solid, pane(glm::vec3(1), 0.5f), matte(glm::vec3(1)), half, metal};
    const double through[] = {0, 0, 0, 0.5, 0};
    Scene scene = floorScene();
    scene.lights = {sun({0, -1, 0})};
    addMesh(scene, level(30, 30), pane());
    for (int i = 0; i < 5; ++i)  // above the camera, side by side
        addMesh(scene, quadMesh({2 * i - 5, 20, 5}, {2, 0, 0}, {0, 0, -10}), roofs[i]);
    const auto frame = renderFrame(device, scene, cameraAt({0, 10, 1e-4}, {0, 0, 0}, 2 * std::atan(0.5)),
                                   square(10), bounces(1), 1);
    for (size_t i = 0; i < 5; ++i)  // seen from above, x goes left
        EXPECT_NEAR(frame[48 - 2 * i].mean[1], 0.5 * through[i] * std::pow(1 - fresnel(1), 2), 1e-5) << i;
}

TEST_F(GlassShadowTest, CoatsTakeTheirShare) {
    Scene scene = floorScene();
    scene.lights = {sun({0, -1, 0})};
    Material coated = pane();
    coated.clearcoat = 1;
    addMesh(scene, level(1, 30), coated);
    EXPECT_NEAR(floorRadiance(device, scene), 0.5 * std::pow(1 - fresnel(1), 2), 1e-3)
        << "the coat's by a table";
}

/// A room of matte walls under a roof of two panes, one of them tinted and coated, and above it every kind of
/// light.
Scene greenhouse() {
    Scene scene = floorScene();
    Material tinted = pane({0.9f, 0.5f, 0.3f});
    tinted.clearcoat = 0.5f;
    addMesh(scene, level(1, 4), tinted);
    addMesh(scene, level(1.5f, 4, false), pane());
    Material shade = matte(glm::vec3(0.6f));
    addMesh(scene, quadMesh({-0.6f, 0, -1}, {0, 1, 0}, {0, 0, 2}), shade);
    addMesh(scene, quadMesh({-1.5f, 2, -1.5f}, {1, 0, 0}, {0, 0, 1}), matte(glm::vec3(0), glm::vec3(6)));
    scene.areaLights = {quadLight({1, 2, 0}, {0.5, 0, 0}, {0, 0, 0.5}, 5), sphereLight({0, 2.5, 1}, 0.5, 5)};
    scene.lights = {sunLight({0.3f, -1, 0.2f}, 0.3f, 1)};
    scene.environment = uniformEnvironment({0.2f, 0.3f, 0.5f});
    return scene;
}

TEST_F(GlassShadowTest, FullEveryWayToSampleLightsFindsTheSameBehindPanes) {
    const Scene scene = greenhouse();
    const Camera camera = cameraAt({0, 0.6, 0.1}, {0, 0, 0}, 1);
    const auto mean = [&](DirectLight directLight, uint32_t samples, uint32_t seed) {
        RenderSettings settings = bounces(4, seed);
        settings.directLight = directLight;
        return meanOf(renderFrame(device, scene, camera, square(8), settings, samples), 0);
    };
    const Mean mis = mean(DirectLight::mis, 512, 1), lights = mean(DirectLight::lights, 512, 2),
               bsdf = mean(DirectLight::bsdf, 2048, 3);
    EXPECT_LT(bsdf.sigma, 0.01 * bsdf.value);
    expectSame(mis, bsdf);
    expectSame(lights, bsdf);
}

TEST_F(GlassShadowTest, PanesAreNoBounces) {
    // Above the pane a white sky, below a floor that shows it: one bounce, whatever the number of panes.
    Scene scene = floorScene();
    scene.environment = uniformEnvironment(glm::vec3(1));
    Material clear = pane();
    clear.ior = 1.0001f;  // reflects 2.5e-9
    for (int i = 0; i < 40; ++i) addMesh(scene, level(1 + 0.01f * static_cast<float>(i), 500), clear);
    expectMean(meanOf(renderFrame(device, scene, kOverFloor, square(4), bounces(1), 256)), 0.5, 1e-3);
    // Seen from above through all of them, and straight at the sky.
    const Camera above = cameraAt({0, 5, 0}, {0, 0, 0}, 0.001),
                 upwards = cameraAt({0, 0.5, 0}, {0, 2, 0}, 0.1);
    expectMean(meanOf(renderFrame(device, scene, above, square(4), bounces(1), 256)), 0.5, 1e-3);
    expectMean(meanOf(renderFrame(device, scene, upwards, square(4), bounces(0), 4)), 1, 1e-5);
}

TEST_F(GlassShadowTest, BeyondTheMostPanesNothingIsLostButBounces) {
    Scene scene = floorScene();
    scene.environment = uniformEnvironment(glm::vec3(1));
    Material clear = pane();
    clear.ior = 1.0001f;
    for (int i = 0; i < 70; ++i) addMesh(scene, level(1 + 0.01f * static_cast<float>(i), 500), clear);
    // After the floor 64 in a row are free, the next is a bounce.
    expectMean(meanOf(renderFrame(device, scene, kOverFloor, square(4), bounces(2), 256)), 0.5, 1e-3);
    EXPECT_LT(meanOf(renderFrame(device, scene, kOverFloor, square(4), bounces(1), 256)).value, 1e-3);
    scene.environment = {};
    scene.lights = {sun({0, -1, 0})};
    EXPECT_EQ(floorRadiance(device, scene, bounces(2)), 0) << "a shadow ray ends at the 65th";
}

TEST_F(GlassShadowTest, LightThroughPanesIsDirect) {
    Scene scene = floorScene();
    scene.lights = {sun({0, -1, 0})};
    addMesh(scene, level(1, 30), pane());
    RenderSettings settings = bounces(4);
    settings.clampIndirect = 1e-6;  // takes what scattered more than once
    EXPECT_NEAR(floorRadiance(device, scene, settings), 0.5 * (1 - fresnel(1)), 1e-4);
}

TEST_F(GlassShadowTest, WhittedsShadowRaysCrossPanesToo) {
    Scene scene = floorScene();
    scene.lights = {sun({0, -1, 0})};
    for (const float roughness : {0.f, 0.5f})
        addMesh(scene, level(1 + roughness, 30), pane(glm::vec3(1), roughness));
    RenderSettings settings = bounces(4);
    settings.integrator = Integrator::whitted;
    EXPECT_NEAR(floorRadiance(device, scene, settings), 0.5 * std::pow(1 - fresnel(1), 2), 1e-4);
    // Panes are no bounces but for the first that the camera sees. From above, by a sun that none of them
    // mirrors there.
    for (int i = 2; i < 18; ++i) addMesh(scene, level(1 + static_cast<float>(i), 500), pane());
    scene.lights = {sun({std::tan(pi / 3), -1, 0})};
    const Camera above = cameraAt({0, 30, 0}, {0, 0, 0}, 0.001);
    const double expected = 0.25 * std::pow((1 - fresnel(1)) * (1 - fresnel(0.5)), 18);
    const double seen = meanOf(renderFrame(device, scene, above, square(2), settings, 1)).value;
    EXPECT_GT(seen, 0.999 * expected);
    EXPECT_LT(seen, 1.25 * expected) << "a little goes back and forth between panes";
}

TEST_F(GlassShadowTest, SixteenPanesInAFurnaceKeepTheirLight) {
    Scene scene;
    scene.environment = uniformEnvironment(glm::vec3(1));
    for (int i = 0; i < 16; ++i)
        addMesh(scene, level(1 - 0.05f * static_cast<float>(i), 2, i % 3 != 0), pane());
    const auto above =
        renderFrame(device, scene, cameraAt({0.1, 4, 0}, {0, 0.6, 0}, 0.6), square(8), bounces(8, 0), 64);
    expectMean(meanOf(above), 1, 1e-3);
    // Flat along them light goes back and forth: what the bounce limit takes of it is what the report says.
    Renderer renderer(device, scene, cameraAt({0.4, 1.2, 4}, {0, 0.6, 0}, 0.2), square(8), bounces(8, 0));
    const PassFilm film = renderer.render(0, std::vector<uint32_t>{0}, {0, 64}).front();
    double found = 0;
    for (const PassPixel& pixel : film.pixels) found += pixel.mean[0] / 64;
    EXPECT_LT(found, 0.99);
    EXPECT_NEAR(found + film.faults.truncatedThroughput / (64 * 64), 1, 1e-3);
}

TEST_F(GlassShadowTest, WhatSolidGlassTakesOfLampsIsCounted) {
    // Half of the floor lies under a block of glass, beside a wall that casts a shadow without being glass.
    const auto counted = [&](float angularRadius, bool withPanes) {
        Scene scene = floorScene();
        Material block = pane();
        block.thickness = 1;
        addMesh(scene, quadMesh({0, 2, 5}, {5, 0, 0}, {0, 0, -10}), block);
        addMesh(scene, quadMesh({-5, 2, 5}, {2.5, 0, 0}, {0, 0, -10}), matte(glm::vec3(1)));
        if (withPanes) addMesh(scene, level(1.5f, 30), pane());
        scene.lights = {sunLight({0, -1, 0}, angularRadius, 1)};
        const Camera camera = cameraAt({0, 1, 1e-4}, {0, 0, 0}, 2 * std::atan(4));
        Renderer renderer(device, scene, camera, square(8), bounces(1));
        return renderer.render(0, std::vector<uint32_t>{0}, {0, 4}).front().faults.lightsBehindGlass;
    };
    EXPECT_EQ(counted(0, false), 4u * 32);
    EXPECT_EQ(counted(0, true), 4u * 32);
    EXPECT_EQ(counted(0.01f, false), 0u) << "of a sun that has a size";
}

/// Cases that were reported.
class SharedGlass : public GlassShadowTest {
protected:
    const std::filesystem::path cases_ = std::filesystem::path(TILEFARM_SHARED_DATA) / "cases";
    void SetUp() override {
        GlassShadowTest::SetUp();
        if (!std::filesystem::exists(cases_)) GTEST_SKIP() << "needs " << cases_;
    }
    Mean meanIn(const std::string& name, const RenderSettings& settings, uint32_t samples) {
        Scene scene = loadGltf(cases_ / (name + ".gltf"));
        lightIfDark(scene);
        Camera camera = selectCamera(scene, "auto", 1);
        camera.yfov = 0.01f;  // what is in the middle
        return meanOf(renderFrame(device, scene, camera, square(8), settings, samples));
    }
};

TEST_F(SharedGlass, LampsWithoutExtentBehindAPane) {
    // The light crosses the pane on its way down, and on its way to the camera at 30°.
    const double seen = 0.8 * (1 - fresnel(1)) * (1 - fresnel(std::cos(pi / 6)));
    expectMean(meanIn("glass-delta-light/pane", bounces(1), 256), seen, 1e-4);
    expectMean(meanIn("glass-delta-light/point", bounces(1), 256), seen, 1e-4);
    // And back and forth between floor and pane, which mirrors some 9 % of it.
    expectMean(meanIn("glass-delta-light/pane", RenderSettings{}, 256), 1.04 * seen, 0.02);
}

TEST_F(SharedGlass, SixteenPanes) {
    expectMean(meanIn("glass-stack-furnace-16/a", RenderSettings{}, 64), 1, 1e-3);
}

TEST_F(SharedGlass, WindowOfOnePlaneWithThickness) {
    // Fresnel takes its share of the sky behind and mirrors as much of that in front.
    // The centimetre absorbs 1 % of red.
    expectMean(meanIn("glass-open-volume/volume", RenderSettings{}, 64), 0.04 + 0.96 * std::pow(0.9, 0.1),
               1e-3);
}

}  // namespace
}  // namespace tilefarm
