// Culling of back faces and the camera's clipping planes, by every integrator, against what the rest shows.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

class CullingTest : public DeviceTest {
protected:
    CullingTest() : DeviceTest({.graphics = true}) {}

    std::vector<FilmPixel> render(const Scene& scene, const Camera& camera, Culling culling,
                                  Integrator integrator = Integrator::path, uint32_t maxBounces = 2) {
        RenderSettings settings = bounces(maxBounces);
        settings.culling = culling;
        settings.integrator = integrator;
        return renderFrame(device, scene, camera, square(16, 16), settings, 4);
    }
};

double coverage(const std::vector<FilmPixel>& frame) {
    double sum = 0;
    for (const FilmPixel& pixel : frame) sum += pixel.alpha;
    return sum / static_cast<double>(frame.size());
}

double luminance(const std::vector<FilmPixel>& frame) {
    return meanOf(frame, 1).value;
}

void expectSameBits(const std::vector<FilmPixel>& a, const std::vector<FilmPixel>& b) {
    size_t other = 0;
    for (size_t i = 0; i < a.size(); ++i) other += a[i].mean != b[i].mean || a[i].alpha != b[i].alpha;
    EXPECT_EQ(other, 0u);
}

constexpr Integrator kAll[] = {Integrator::path, Integrator::whitted, Integrator::raster, Integrator::normal,
                               Integrator::ambientOcclusion};

Mesh wall(double z, bool towardsCamera) {
    const auto at = static_cast<float>(z);
    return towardsCamera ? quadMesh({-9, -9, at}, {18, 0, 0}, {0, 18, 0})
                         : quadMesh({-9, -9, at}, {0, 18, 0}, {18, 0, 0});
}

/// A wall that faces the camera 4 m away, and before its left half one that does not.
Scene walls(bool coversAll = false) {
    Scene scene;
    addMesh(scene, wall(-4, true), matte(glm::vec3(0.5f)));
    addMesh(scene, wall(-1, false), matte(glm::vec3(0.25f)),
            glm::translate(glm::dmat4(1), glm::dvec3(coversAll ? 0 : -9, 0, 0)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    return scene;
}

const Camera kCamera = cameraAt({0, 0, 0}, {0, 0, -1}, 1);

TEST_F(CullingTest, TheCameraSeesThroughBacksInEveryIntegrator) {
    const auto depths = [&](Culling culling, Integrator integrator) {
        const auto frame = render(walls(), kCamera, culling, integrator);
        EXPECT_EQ(coverage(frame), 1) << int(integrator);
        return std::pair(frame[8 * 16 + 1].depth, frame[8 * 16 + 14].depth);
    };
    for (const Integrator integrator : kAll) {
        const auto [left, right] = depths(Culling::camera, integrator);
        EXPECT_GT(left, 4 * 0.99) << int(integrator);
        EXPECT_GT(right, 4 * 0.99) << int(integrator);
    }
    EXPECT_LT(depths(Culling::none, Integrator::path).first, 1.5);
}

TEST_F(CullingTest, BehindTheLastBackIsTheEnvironment) {
    Scene scene;
    addMesh(scene, wall(-1, false), matte(glm::vec3(0.25f)));
    scene.environment = uniformEnvironment(glm::vec3(2));
    for (const Integrator integrator : {Integrator::path, Integrator::whitted, Integrator::raster}) {
        const auto frame = render(scene, kCamera, Culling::camera, integrator);
        EXPECT_EQ(coverage(frame), 0);
        EXPECT_EQ(luminance(frame), 2);
    }
}

// A room seen from outside, lit by what its walls emit: 1 / (1 − 0.5) of it after all bounces.
TEST_F(CullingTest, LightMeetsWhatTheCameraSeesThrough) {
    Scene room;
    addMesh(room, cubeMesh(true), matte(glm::vec3(0.5f), glm::vec3(1)));
    const Camera outside = cameraAt({0, 0, 8}, {0, 0, 0}, 0.1);
    const auto seen = render(room, outside, Culling::camera, Integrator::path, 4);
    EXPECT_NEAR(luminance(seen), 1 + 0.5 + 0.25 + 0.125 + 0.0625, 0.02) << "as from within";
    EXPECT_EQ(coverage(seen), 1);
    // Of the faces that meet its edges at a right angle a back sees the cosines' rounding.
    EXPECT_NEAR(luminance(render(room, outside, Culling::none, Integrator::path, 4)), 0, 1e-12)
        << "its backs are black";
}

// A floor under a roof that turns its back to it: shadow rays from the floor meet backs.
TEST_F(CullingTest, AllRaysPassBacksWhereAJobSaysSo) {
    Scene scene;
    addMesh(scene, quadMesh({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), matte(glm::vec3(0.5f)));
    addMesh(scene, quadMesh({-99, 9, 99}, {198, 0, 0}, {0, 0, -198}), matte(glm::vec3(0)));  // faces up
    PunctualLight sun;
    sun.type = PunctualType::directional;
    sun.direction = {0, -1, 0};
    sun.color = glm::vec3(3);
    scene.lights.push_back(sun);
    const Camera below = cameraAt({0, 2, 0.01}, {0, 0, 0}, 0.3);
    EXPECT_EQ(luminance(render(scene, below, Culling::camera)), 0) << "the roof's shadow";
    for (const Integrator integrator : {Integrator::path, Integrator::whitted})
        EXPECT_NEAR(luminance(render(scene, below, Culling::all, integrator)), 1.5 / M_PI, 1e-5);
    EXPECT_EQ(luminance(render(scene, below, Culling::all, Integrator::ambientOcclusion)), 1);
}

TEST_F(CullingTest, FrontsOfMirroredNodesStayFronts) {
    const glm::dmat4 mirrored = glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1));
    for (const bool front : {true, false}) {
        Scene scene;
        addMesh(scene, wall(-1, front), matte(glm::vec3(1)), mirrored);
        for (const Integrator integrator : {Integrator::path, Integrator::raster})
            EXPECT_EQ(coverage(render(scene, kCamera, Culling::camera, integrator)), front ? 1 : 0);
    }
}

TEST_F(CullingTest, TheExitOfASolidStays) {
    Scene scene;
    Material glass = matte(glm::vec3(1));
    glass.transmission = glass.thickness = 1;
    glass.roughness = 0;
    addMesh(scene, cubeMesh(false), glass);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera within = cameraAt({0, 0, 0}, {0, 0.1, -1}, 0.5);
    expectSameBits(render(scene, within, Culling::all), render(scene, within, Culling::none));
}

TEST_F(CullingTest, BacksOfCutOutsAndOfShapesArePassedToo) {
    Scene scene;
    Material half = matte(glm::vec3(1));
    half.alphaMode = AlphaMode::blend;
    half.alpha = 0.5f;
    addMesh(scene, wall(-1, false), half);
    EXPECT_EQ(coverage(render(scene, kCamera, Culling::camera)), 0);
    EXPECT_NEAR(coverage(render(scene, kCamera, Culling::none)), 0.5, 0.1);

    Scene around;
    around.materials.push_back(matte(glm::vec3(1)));
    for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::box, ShapeKind::cylinder}) {
        Shape shape;
        shape.kind = kind;
        shape.size = {3, 3, 3};
        around.shapes.push_back(shape);
    }
    const Camera outside = cameraAt({0, 0, 12}, {0, 0, 0}, 0.1);
    EXPECT_EQ(coverage(render(around, kCamera, Culling::none)), 1);
    for (const Integrator integrator : {Integrator::path, Integrator::raster}) {
        EXPECT_EQ(coverage(render(around, kCamera, Culling::camera, integrator)), 0) << "from within";
        EXPECT_EQ(coverage(render(around, outside, Culling::all, integrator)), 1);
    }
}

// A kernel that culls for one frame renders another one's pixels as if it did not.
TEST_F(CullingTest, ScenesWithoutBacksInSightDoNotPay) {
    Scene scene;
    addMesh(scene, cubeMesh(false), matte(glm::vec3(0.5f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera outside = cameraAt({0, 0.5, 4}, {0, 0, 0}, 0.8),
                 within = cameraAt({0, 0, 0}, {0, 0, 1}, 0.8);
    const auto calls = [&](const Camera& camera, Culling culling) {
        RenderSettings settings = bounces(1);
        settings.culling = culling;
        Renderer renderer(device, scene, camera, square(8, 8), settings);
        return (renderer.featureBits() & gpu::bit(gpu::FEATURE_CULLING)) != 0;
    };
    EXPECT_FALSE(calls(outside, Culling::camera));
    EXPECT_TRUE(calls(within, Culling::camera));
    EXPECT_FALSE(calls(within, Culling::none));
    EXPECT_TRUE(calls(outside, Culling::all));
}

TEST_F(CullingTest, ClippingPlanesCutWhatTheCameraSees) {
    Scene scene;
    addMesh(scene, wall(-1, true), matte(glm::vec3(0.25f)));
    addMesh(scene, wall(-4, true), matte(glm::vec3(0.5f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const auto between = [&](bool flat, float znear, float zfar, Integrator integrator) {
        Camera camera = kCamera;
        camera.orthographic = flat;
        camera.clips = true;
        camera.znear = znear, camera.zfar = zfar;
        return render(scene, camera, Culling::camera, integrator);
    };
    for (const Integrator integrator : kAll) {
        const auto farther = between(false, 2, 5, integrator);
        EXPECT_EQ(coverage(farther), 1) << int(integrator);
        EXPECT_NEAR(farther[8 * 16 + 8].depth, 4, 0.1) << int(integrator);
    }
    for (const Integrator integrator : {Integrator::path, Integrator::raster}) {
        EXPECT_NEAR(between(true, 2, 5, integrator)[8 * 16 + 8].depth, 4, 0.1) << int(integrator);
        EXPECT_NEAR(between(true, 0.5f, 3, integrator)[8 * 16 + 8].depth, 1, 0.1) << int(integrator);
        EXPECT_EQ(coverage(between(false, 2, 3, integrator)), 0) << int(integrator);
    }
}

// By depth along the view direction and not by distance: a wall at 4 m is whole or gone, into the corners of
// the picture.
TEST_F(CullingTest, ClippingPlanesArePlanesForTheLensToo) {
    Scene scene;
    addMesh(scene, wall(-4, true), matte(glm::vec3(0.5f)));
    Camera camera = cameraAt({0, 0, 0}, {0, 0, -1}, 1.6);
    camera.clips = true;
    camera.apertureRadius = 0.5f;
    camera.focusDistance = 2;
    for (const Integrator integrator : {Integrator::path, Integrator::raster}) {
        camera.zfar = 4.01f;
        EXPECT_EQ(coverage(render(scene, camera, Culling::none, integrator)), 1);
        camera.zfar = 3.99f;
        EXPECT_EQ(coverage(render(scene, camera, Culling::none, integrator)), 0);
    }
}

// What is clipped is clipped for the camera alone: light and mirrors meet it.
TEST_F(CullingTest, LightMeetsWhatIsClipped) {
    Scene scene;
    addMesh(scene, wall(-4, true), matte(glm::vec3(0.5f)));
    addMesh(scene, wall(-1, false), matte(glm::vec3(0), glm::vec3(1)));  // lights the other wall
    Camera camera = kCamera;
    camera.znear = 2;
    camera.clips = true;
    const auto frame = render(scene, camera, Culling::none);
    // From 3 m off, the square of side 18 has the form factor of its middle: 4 / π · k atan k with X = 3.
    const double x = 3, k = x / std::sqrt(1 + x * x), factor = 4 / M_PI * k * std::atan(k);
    EXPECT_NEAR(frame[8 * 16 + 8].mean[1], 0.5 * factor, 0.2);
    EXPECT_GT(luminance(frame), 0.3);
}

}  // namespace
}  // namespace tilefarm
