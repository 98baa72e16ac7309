// Images whose value is known in closed form, rendered by the real renderer, judged by z-tests.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "shared/error/error.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class PathTraceTest : public DeviceTest {};

TEST_F(PathTraceTest, ConvexMatteObjectUnderUniformSkyShowsItsAlbedo) {
    Scene scene;
    addMesh(scene, sphereMesh(64), matte({0.8f, 0.5f, 0.2f}));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const auto frame =
        renderFrame(device, scene, cameraAt({0, 0, 4}, {0, 0, 0}, 0.3), square(32), bounces(4), 64);
    // The shading normals of a mesh sphere differ from the flat ones: a little light is lost between them.
    expectMean(meanOf(frame, 0, hit), 0.8, 2e-3);
    expectMean(meanOf(frame, 1, hit), 0.5, 2e-3);
    expectMean(meanOf(frame, 2, hit), 0.2, 2e-3);
}

TEST_F(PathTraceTest, AnythingWhiteUnderUniformSkyIsInvisible) {
    Material plastic;
    plastic.metallic = 0;
    plastic.roughness = 0.3f;
    Scene scene;
    addMesh(scene, cubeMesh(false), plastic);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const auto frame =
        renderFrame(device, scene, cameraAt({3, 2, 4}, {0, 0, 0}, 0.4), square(32), bounces(4), 256);
    expectMean(meanOf(frame, 0, hit), 1, 3e-3);
}

TEST_F(PathTraceTest, GlassUnderUniformSkyIsInvisible) {
    Material glass;
    glass.metallic = 0;
    glass.roughness = 0;
    glass.transmission = 1;
    glass.thickness = 1;
    Scene scene;
    addMesh(scene, sphereMesh(48), glass);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const auto frame =
        renderFrame(device, scene, cameraAt({0, 0, 4}, {0, 0, 0}, 0.3), square(32), bounces(64), 64);
    expectMean(meanOf(frame, 0, hit), 1, 5e-3);
}

TEST_F(PathTraceTest, ColouredGlassAbsorbsByBeerLambert) {
    Material slab;
    slab.metallic = 0;
    slab.roughness = 0;
    slab.ior = 1;  // straight through, so that the path inside is known
    slab.transmission = 1;
    slab.thickness = 1;
    slab.attenuationColor = {0.5f, 0.25f, 1};
    slab.attenuationDistance = 2;
    Scene scene;
    addMesh(scene, cubeMesh(false), slab, glm::scale(glm::dmat4(1), glm::dvec3(10, 10, 1)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const auto frame =
        renderFrame(device, scene, cameraAt({0, 0, 50}, {0, 0, 0}, 0.01), square(8), bounces(8), 64);
    expectMean(meanOf(frame, 0), 0.5, 1e-4);
    expectMean(meanOf(frame, 1), 0.25, 1e-4);
    expectMean(meanOf(frame, 2), 1, 1e-4);
}

TEST_F(PathTraceTest, GlowingFurnaceFillsToItsGeometricSeries) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.5f), glm::vec3(0.5f)));
    const auto frame =
        renderFrame(device, scene, cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2), square(32), bounces(200), 64);
    expectMean(meanOf(frame), 1, 1e-3);
}

TEST_F(PathTraceTest, BounceLimitCutsTheSeriesWhereItSays) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.5f), glm::vec3(1)));
    double expected = 0;
    for (uint32_t limit = 0; limit < 4; ++limit) {
        expected += std::pow(0.5, limit);
        const auto frame = renderFrame(device, scene, cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2), square(16),
                                       bounces(limit), 64);
        expectMean(meanOf(frame), expected, 1e-3);
    }
}

TEST_F(PathTraceTest, RussianRouletteLeavesTheMeanAlone) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.8f), glm::vec3(0.2f)));
    for (const uint32_t start : {1u, 4u, 1000u}) {
        RenderSettings settings = bounces(100);
        settings.rouletteStart = start;
        const auto frame =
            renderFrame(device, scene, cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2), square(16), settings, 128);
        expectMean(meanOf(frame), 1, 1e-3);
    }
}

// Irradiance of a polygon: Lambert's formula, 1/2 Σ angle of edge times the cosine of its plane.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point,
                         const glm::dvec3& normal) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - point),
                         b = glm::normalize(corners[(i + 1) % corners.size()] - point);
        sum += std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) *
               glm::dot(glm::normalize(glm::cross(a, b)), normal);
    }
    return std::abs(sum) / 2;
}

TEST_F(PathTraceTest, QuadLightGivesLambertsPolygonFormula) {
    Scene scene;
    addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
    addMesh(scene, quadMesh({-1, 1.5f, -1}, {2, 0, 0}, {0, 0, 2}), matte(glm::vec3(0), glm::vec3(4)));
    const auto frame =
        renderFrame(device, scene, cameraAt({0.7, 1, 0.2}, {0.7, 0, 0.2}, 1e-3), square(16), bounces(1), 256);
    const double irradiance = 4 * polygonIrradiance({{-1, 1.5, -1}, {1, 1.5, -1}, {1, 1.5, 1}, {-1, 1.5, 1}},
                                                    {0.7, 0, 0.2}, {0, 1, 0});
    expectMean(meanOf(frame), 0.5 / pi * irradiance, 1e-4);
}

TEST_F(PathTraceTest, PointAndSpotAndDirectionalLightsGiveTheirFormulas) {
    const auto lit = [&](const PunctualLight& light) {
        Scene scene;
        addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
        scene.lights = {light};
        const auto frame =
            renderFrame(device, scene, cameraAt({1, 1, 0}, {1, 0, 0}, 1e-3), square(8), bounces(1), 4);
        return meanOf(frame).value;
    };
    PunctualLight light;
    light.color = glm::vec3(3);
    light.position = {0, 2, 0};
    const double cosTheta = 2 / std::sqrt(5.0);
    EXPECT_NEAR(lit(light), 0.5 / pi * 3 * cosTheta / 5, 1e-4);
    light.type = PunctualType::spot;
    light.direction = {0, -1, 0};
    light.innerCone = 0.2f;
    light.outerCone = 0.6f;
    const double t = (cosTheta - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6));
    EXPECT_NEAR(lit(light), 0.5 / pi * 3 * cosTheta / 5 * t * t, 1e-4);
    light.type = PunctualType::directional;
    light.direction = glm::normalize(glm::vec3(1, -1, 0));
    EXPECT_NEAR(lit(light), 0.5 / pi * 3 / std::sqrt(2.0), 1e-4);
}

TEST_F(PathTraceTest, SunInTheEnvironmentGivesItsIrradiance) {
    Scene scene;
    addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
    scene.environment = uniformEnvironment(glm::vec3(0), 32, 16);
    float* texel = &scene.environment.image.rgbaFloat[4 * (3 * 32 + 20)];
    texel[0] = texel[1] = texel[2] = 50;
    // The bilinear sun integrated against the cosine in double.
    constexpr int n = 400;
    double irradiance = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double dx = 2.0 * (i + 0.5) / n - 1, dy = 2.0 * (j + 0.5) / n - 1,
                         theta = pi * (3.5 + dy) / 16;
            irradiance += 50 * (1 - std::abs(dx)) * (1 - std::abs(dy)) * std::cos(theta) * std::sin(theta);
        }
    irradiance *= 4.0 / (n * n) * (2 * pi / 32) * (pi / 16);
    const auto frame =
        renderFrame(device, scene, cameraAt({1, 1, 0}, {1, 0, 0}, 1e-3), square(16), bounces(1), 256);
    expectMean(meanOf(frame), 0.5 / pi * irradiance, 1e-4);
}

TEST_F(PathTraceTest, CutoutLetsThroughWhatItsAlphaSays) {
    Material veil = matte(glm::vec3(0));
    veil.alphaMode = AlphaMode::blend;
    veil.alpha = 0.25f;
    Scene scene;
    addMesh(scene, quadMesh({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), veil);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.1);
    expectMean(meanOf(renderFrame(device, scene, camera, square(16), bounces(2), 256)), 0.75, 1e-3);
    scene.materials[0].alphaMode = AlphaMode::mask;
    EXPECT_FLOAT_EQ(meanOf(renderFrame(device, scene, camera, square(16), bounces(2), 1)).value, 1)
        << "below the cutoff";
    scene.materials[0].alphaCutoff = 0.25f;
    EXPECT_FLOAT_EQ(meanOf(renderFrame(device, scene, camera, square(16), bounces(2), 1)).value, 0)
        << "at the cutoff: visible";
}

TEST_F(PathTraceTest, TexturesAreDecodedBeforeTheyAreFiltered) {
    Scene scene;
    Material wall = matte(glm::vec3(1));
    scene.images.push_back({"edge", 2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, {}});
    wall.unlit = true;
    wall.baseColorTexture.image = 0;
    wall.baseColorTexture.srgb = true;
    addMesh(scene, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), wall);
    // The middle of the image is the edge between a red and a green texel: half of each, in linear light.
    const auto frame =
        renderFrame(device, scene, cameraAt({0, 0, 5}, {0, 0, 0}, 1e-5), square(8), bounces(1), 4);
    EXPECT_NEAR(meanOf(frame, 0).value, 0.5, 1e-3);
    EXPECT_NEAR(meanOf(frame, 1).value, 0.5, 1e-3);
}

TEST_F(PathTraceTest, SamplesDependOnNeitherTileSizeNorOrderNorBatch) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.7f), glm::vec3(0.1f)));
    const Camera camera = cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2);
    const auto reference = renderFrame(device, scene, camera, square(40, 128), bounces(6), 8);
    const auto small = renderFrame(device, scene, camera, square(40, 16), bounces(6), 8);
    for (size_t i = 0; i < reference.size(); ++i) {
        ASSERT_EQ(reference[i].mean, small[i].mean) << i;
        ASSERT_EQ(reference[i].m2, small[i].m2) << i;
    }
    Renderer renderer(device, scene, camera, square(40, 16), bounces(6));
    const std::vector<uint32_t> backwards{8, 3, 0};
    const auto some = renderer.render(0, backwards, {0, 1});
    const auto alone = renderer.render(0, std::vector<uint32_t>{3}, {0, 1});
    EXPECT_EQ(std::memcmp(some[1].pixels.data(), alone[0].pixels.data(),
                          alone[0].pixels.size() * sizeof(PassPixel)),
              0);
    EXPECT_EQ(some[0].rect, TileGrid(square(40, 16)).rect(8));
}

TEST_F(PathTraceTest, SeedsAndFramesGiveOtherNoise) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.7f), glm::vec3(0.1f)));
    const Camera camera = cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2);
    Renderer one(device, scene, camera, square(16), bounces(6, 1)),
        two(device, scene, camera, square(16), bounces(6, 2));
    const std::vector<uint32_t> tile{0};
    const auto a = one.render(0, tile, {0, 1}), b = two.render(0, tile, {0, 1}),
               c = one.render(1, tile, {0, 1});
    EXPECT_NE(a[0].pixels[0].mean, b[0].pixels[0].mean);
    EXPECT_NE(a[0].pixels[0].mean, c[0].pixels[0].mean);
    EXPECT_EQ(a[0].pixels[0].mean, one.render(0, tile, {0, 1})[0].pixels[0].mean);
}

TEST_F(PathTraceTest, EmptySceneShowsOnlyTheSky) {
    Scene scene;
    scene.materials.emplace_back();
    const Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.5);
    EXPECT_EQ(meanOf(renderFrame(device, scene, camera, square(8), bounces(2), 1)).value, 0);
    scene.environment = uniformEnvironment(glm::vec3(0.25f));
    EXPECT_FLOAT_EQ(meanOf(renderFrame(device, scene, camera, square(8), bounces(2), 1)).value, 0.25f);
}

TEST_F(PathTraceTest, HoldsOnlyTheEffectsThatTheSceneCallsFor) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.7f), glm::vec3(0.1f)));
    Renderer renderer(device, scene, cameraAt({0, 0, 0}, {0, 0, -1}, 1), square(8), bounces(1));
    EXPECT_THAT(renderer.features().used, testing::ElementsAre("emissive triangles"));
    EXPECT_THAT(renderer.features().leftOut, testing::Contains("textures"));
}

TEST_F(PathTraceTest, RefusesATileThatIsNotThere) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.7f)));
    Renderer renderer(device, scene, cameraAt({0, 0, 0}, {0, 0, -1}, 1), square(8), bounces(1));
    EXPECT_THROW(renderer.render(0, std::vector<uint32_t>{1}, {0, 1}), Error);
}

}  // namespace
}  // namespace tilefarm
