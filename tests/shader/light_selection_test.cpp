// Choosing among many lights: every way gives the same picture; the tree's probabilities are what it samples
// by; and it is worth having.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/shader/light_scenes.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

void addFloor(Scene& scene, float half, const Material& material) {
    addMesh(scene, quadMesh({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}), material);
}

PunctualLight lampAt(const glm::dvec3& position, float intensity) {
    PunctualLight lamp;
    lamp.position = position;
    lamp.color = glm::vec3(intensity);
    return lamp;
}

/// One light of every kind over a floor.
Scene everyKind() {
    Scene scene;
    addFloor(scene, 5, matte(glm::vec3(0.5f)));
    addMesh(scene, quadMesh({1, 1, -1}, {0.5f, 0, 0}, {0, 0, 0.4f}), matte(glm::vec3(0), glm::vec3(6)));
    scene.areaLights = {quadLight({-1, 1, 0.5}, {0.2, 0, 0}, {0, 0, 0.3}, 8),
                        quadLight({0, 0.8, -1.5}, {0.2, 0, 0}, {0, 0.3, 0.1}, 5)};
    scene.areaLights[1].twoSided = true;
    scene.areaLights.push_back(sphereLight({-0.4, 0.9, -0.6}, 0.15, 4));
    PunctualLight spot = lampAt({0.5, 1.5, 0.5}, 2);
    spot.type = PunctualType::spot;
    spot.direction = glm::normalize(glm::vec3(-0.3f, -1, -0.2f));
    spot.innerCone = 0.3f;
    spot.outerCone = 0.9f;
    PunctualLight beam = sunLight({0.2f, -1, 0.4f}, 0, 0.5f);
    scene.lights = {lampAt({0.3, 0.6, -0.2}, 0.4f), spot, beam, sunLight({-1, -2, 0.3f}, 0.05f, 0.6f)};
    for (const double x : {-2., 2.}) scene.lights.push_back(lampAt({x, 0.5, 1}, 0.2f));
    scene.environment = oneTexelSun(16, 8, 9, 2, 3);
    return scene;
}

/// Small lamps in a plane above the floor, facing down: emissive triangles, `side`² of them, their sum of
/// power fixed.
Scene manyLamps(int side, float extent, float height) {
    Scene scene;
    addFloor(scene, extent, matte(glm::vec3(0.5f)));
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    const float pitch = 2 * extent / float(side), size = 0.12f * pitch;
    Mesh lamps;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const glm::vec3 p{-extent + pitch * (float(i) + 0.3f * uniform(random)),
                              height * (0.8f + 0.4f * uniform(random)),
                              -extent + pitch * (float(j) + 0.3f * uniform(random))};
            const auto first = static_cast<uint32_t>(lamps.positions.size());
            lamps.positions.insert(lamps.positions.end(),
                                   {p, p + glm::vec3(size, 0, 0), p + glm::vec3(0, 0, size)});
            lamps.triangles.emplace_back(first, first + 1, first + 2);
        }
    addMesh(scene, lamps, matte(glm::vec3(0), glm::vec3(5)));
    return scene;
}

class LightSelectionTest : public DeviceTest {
protected:
    std::vector<FilmPixel> frame(const Scene& scene, const Camera& camera, LightSelection selection,
                                 uint32_t samples, uint32_t bounceCount = 1, uint32_t size = 16) {
        RenderSettings settings = bounces(bounceCount, 1 + static_cast<uint32_t>(selection));
        settings.lightSelection = selection;
        return renderFrame(device, scene, camera, square(size), settings, samples);
    }
};

double varianceOf(const std::vector<FilmPixel>& frame) {
    double sum = 0;
    for (const FilmPixel& pixel : frame) sum += pixel.varianceOfMean(0);
    return sum / double(frame.size());
}

TEST_F(LightSelectionTest, EveryWayOfChoosingGivesTheSamePicture) {
    const Scene scene = everyKind();
    const Camera camera = cameraAt({1, 2.5, 3}, {0, 0, 0}, 0.6);
    const Mean all = meanOf(frame(scene, camera, LightSelection::all, 32, 2));
    for (const LightSelection selection :
         {LightSelection::power, LightSelection::uniform, LightSelection::tree}) {
        SCOPED_TRACE(static_cast<int>(selection));
        expectSame(all, meanOf(frame(scene, camera, selection, 128, 2)));
    }
}

TEST_F(LightSelectionTest, GlassAndVeilsSeeTheLightsOnBothSides) {
    // A thin rough pane and a lamp behind it: the tree must not leave the far side out.
    Scene scene = everyKind();
    scene.environment = {};
    scene.lights.clear();
    for (int i = 0; i < 6; ++i) scene.lights.push_back(lampAt({i - 2.5, 1, 0.3 * i}, 0.3f));
    Material pane = matte(glm::vec3(1));
    pane.ior = 1.5f;
    pane.roughness = 0.7f;
    pane.transmission = 1;
    addMesh(scene, quadMesh({-3, 0.3f, 3}, {6, 0, 0}, {0, 0, -6}), pane);
    const Camera camera = cameraAt({0.5, -2, 0.3}, {0, 0.3, 0}, 0.6);
    scene.meshes[0].positions = {{50, 0, 0}, {51, 0, 0}, {51, 0, 1}, {50, 0, 1}};  // the floor out of the way
    expectSame(meanOf(frame(scene, camera, LightSelection::power, 256)),
               meanOf(frame(scene, camera, LightSelection::tree, 256)));
}

TEST_F(LightSelectionTest, PowersOfAnySizeStandTogether) {
    // Hard case 34: faint lights do not spoil a bright one, and nothing is infinite. (1e15: the film's sum of
    // squares ends at 1e38.)
    Scene scene;
    addFloor(scene, 5, matte(glm::vec3(0.5f)));
    scene.lights = {lampAt({0, 1, 0}, 1e-30f), lampAt({1, 2, 0}, 0), lampAt({0, 2, 0}, 1e15f)};
    scene.areaLights = {quadLight({0, 1, 1}, {0.1, 0, 0}, {0, 0, 0.1}, 0),
                        quadLight({0, 1, 1}, {0, 0, 0}, {0, 0, 1}, 1)};
    for (const LightSelection selection :
         {LightSelection::power, LightSelection::all, LightSelection::tree}) {
        const Mean mean = meanOf(frame(scene, cameraAt({-0.7, 0.5, -0.6}, {0, 0, 0}, 1e-4), selection, 4));
        EXPECT_NEAR(mean.value / 1e15, 0.5 / pi / 4, 1e-4) << static_cast<int>(selection);
    }

    scene.lights[2].color = glm::vec3(1e30f);
    for (int i = 0; i < 8; ++i) scene.lights.push_back(lampAt({double(i), 1, 1}, 1e-30f));
    RenderSettings settings;
    settings.lightSelection = LightSelection::tree;
    LightProbe probe(device, scene, settings);
    ASSERT_EQ(probe.lightCount(), 10u);
    double sum = 0;
    for (uint32_t light = 0; light < 10; ++light)
        sum += probe.ask({{{0, 0, 0, 0}, {0, 1, 0, 0}, {}, {}, {PROBE_PMF, light, 0, 0}}}).front().chosen.z;
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST_F(LightSelectionTest, TreeSamplesByTheProbabilitiesThatItGives) {
    // Hard case 38.
    Scene scene = manyLamps(100, 10, 0.5f);
    scene.lights = {lampAt({1, 1, 1}, 0.1f), sunLight({1, -1, 0}, 0.01f)};
    scene.environment = uniformEnvironment(glm::vec3(0.1f));
    RenderSettings settings;
    settings.lightSelection = LightSelection::tree;
    LightProbe probe(device, scene, settings);
    ASSERT_EQ(probe.lightCount(), 10003u);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-9, 9);
    std::vector<LightQuery> queries(20000);
    for (size_t i = 0; i < queries.size(); ++i) {
        queries[i].position = {uniform(random), 0, uniform(random), 0};
        queries[i].normal = i % 3 == 0 ? glm::vec4(0) : glm::vec4(0, 1, 0, 0);
        queries[i].bits = {random(), random(), random(), random()};
        queries[i].ask.x = PROBE_TREE;
    }
    for (const LightAnswer& a : probe.ask(queries)) {
        ASSERT_EQ(a.radiance.w, 1);
        ASSERT_GT(a.chosen.y, 0);
        ASSERT_NEAR(a.chosen.z, a.chosen.y, 1e-5 * a.chosen.y);
    }

    // From one point: the probabilities of all lights sum to 1, and the counts follow them.
    const glm::vec4 point{0.3f, 0, -2.1f, 0}, normal{0, 1, 0, 0};
    std::vector<LightQuery> asked(probe.lightCount()), drawn(200000);
    for (uint32_t i = 0; i < asked.size(); ++i) asked[i] = {point, normal, {}, {}, {PROBE_PMF, i, 0, 0}};
    for (LightQuery& q : drawn)
        q = {point, normal, {}, {random(), random(), random(), random()}, {PROBE_TREE, 0, 0, 0}};
    std::vector<double> pmf, seen(asked.size());
    double sum = 0;
    for (const LightAnswer& a : probe.ask(asked)) sum += pmf.emplace_back(a.chosen.z);
    EXPECT_NEAR(sum, 1, 1e-5);
    for (const LightAnswer& a : probe.ask(drawn)) {
        uint32_t light;
        std::memcpy(&light, &a.chosen.x, sizeof light);
        ++seen.at(light);
    }
    double chi2 = 0, restExpected = 0, restSeen = 0;
    int cells = 0;
    for (size_t i = 0; i < pmf.size(); ++i) {
        const double expected = pmf[i] * double(drawn.size());
        if (expected < 10) {
            restExpected += expected;
            restSeen += seen[i];
            continue;
        }
        chi2 += std::pow(seen[i] - expected, 2) / expected;
        ++cells;
    }
    chi2 += std::pow(restSeen - restExpected, 2) / restExpected;
    ASSERT_GT(cells, 50);
    EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells)) << cells << " cells";
}

TEST_F(LightSelectionTest, TenThousandLightsAreUnbiasedAndHaveATenthOfTheVariance) {
    const Scene scene = manyLamps(100, 10, 0.5f);
    const Camera camera = cameraAt({0.5, 0.35, 0.4}, {0, 0, 0}, 0.5);  // sees the floor alone
    const auto tree = frame(scene, camera, LightSelection::tree, 64),
               uniform = frame(scene, camera, LightSelection::uniform, 64);
    const auto power = frame(scene, camera, LightSelection::power, 64);
    expectSame(meanOf(tree), meanOf(uniform));
    const double ratio = varianceOf(uniform) / varianceOf(tree);
    fmt::print("variance at equal samples: uniform / tree = {:.1f}, power / tree = {:.1f}\n", ratio,
               varianceOf(power) / varianceOf(tree));
    EXPECT_GT(ratio, 10);
}

/// Two lamps of many triangles each, as two nodes of a file.
Scene twoLamps() {
    Scene scene;
    addFloor(scene, 5, matte(glm::vec3(0.5f)));
    for (const double x : {-1.5, 1.5}) {
        addMesh(scene, sphereMesh(16), matte(glm::vec3(0), glm::vec3(4)),
                glm::scale(glm::translate(glm::dmat4(1), {x, 1.5, 0.}), glm::dvec3(0.4)));
        scene.instances.back().nodeIndex = static_cast<uint32_t>(scene.instances.size());
    }
    return scene;
}

TEST_F(LightSelectionTest, AllAsksEachLampOnce) {
    const Scene scene = twoLamps();
    const Camera camera = cameraAt({0, 3, 4}, {0, 0, 0}, 0.6);
    RenderSettings settings = bounces(1);
    settings.lightSelection = LightSelection::all;
    Renderer renderer(device, scene, camera, square(16), settings);
    renderer.render(0, std::vector<uint32_t>{0}, {0, 16});
    const RenderStats& stats = renderer.stats();
    // The camera's ray, one to each lamp, and the one that goes on.
    EXPECT_LE(stats.rays, 4 * stats.samples);
    EXPECT_EQ(renderer.lights().lights, 2u);
    EXPECT_EQ(renderer.lights().emissiveGroups, 2u);
    EXPECT_GT(renderer.lights().emissiveTriangles, 1800u);
    expectSame(meanOf(frame(scene, camera, LightSelection::all, 64, 2)),
               meanOf(frame(scene, camera, LightSelection::power, 128, 2)));
}

TEST_F(LightSelectionTest, WhereDispatchesAreCutDoesNotShow) {
    // Two thousand lamps, most of them below the floor: by their number a dispatch takes half a tile, or a
    // smaller one.
    Scene scene;
    addFloor(scene, 5, matte(glm::vec3(0.5f)));
    for (int i = 0; i < 2000; ++i) scene.lights.push_back(lampAt({0.002 * i, i < 4 ? 1.0 : -1.0, 0.3}, 0.2f));
    RenderSettings settings = bounces(1);
    settings.lightSelection = LightSelection::all;
    const Camera camera = cameraAt({0, 3, 4}, {0, 0, 0}, 0.6);
    const auto rendered = [&](uint32_t tile) {
        Renderer renderer(device, scene, camera, square(128, tile), settings);
        std::vector<PassPixel> pixels(size_t{128} * 128);
        for (const PassFilm& film : renderer.render(0, allTiles(square(128, tile)), {0, 2}))
            for (size_t i = 0; i < film.pixels.size(); ++i)
                pixels[(film.rect.y + i / film.rect.width) * 128 + film.rect.x + i % film.rect.width] =
                    film.pixels[i];
        return pixels;
    };
    const std::vector<PassPixel> large = rendered(128), small = rendered(32);
    EXPECT_EQ(std::memcmp(large.data(), small.data(), large.size() * sizeof(PassPixel)), 0);
}

}  // namespace
}  // namespace tilefarm
