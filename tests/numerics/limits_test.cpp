// Cases 30, 44 and 47: absorption, bounds on samples, and apertures, from nothing to everything.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"

namespace tilefarm {
namespace {

class HardLimits : public DeviceTest {};

// ---- 30

/// A ball of glass that bends nothing, `scale` in radius, before a white sky.
Scene absorbing(const glm::vec3& color, double distance, double scale) {
    Material m;
    m.metallic = 0;
    m.roughness = 0;
    m.ior = 1;
    m.transmission = 1;
    m.thickness = 1;
    m.attenuationColor = color;
    m.attenuationDistance = static_cast<float>(distance);
    Scene scene;
    addMesh(scene, sphereMesh(24), m, glm::scale(glm::dmat4(1), glm::dvec3(scale)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    return scene;
}

Picture throughBall(const gpu::Device& device, const glm::vec3& color, double distance, double scale) {
    return render(device, absorbing(color, distance, scale), cameraAt({0, 0, 3 * scale}, {0, 0, 0}, 0.5),
                  {.size = 24, .samples = 8, .maxBounces = 4, .rouletteStart = 8});
}

TEST_F(HardLimits, HardCase30_AbsorptionFromNothingToEverything) {
    const auto expectEach = [](const Picture& picture, size_t channel, double expected) {
        EXPECT_TRUE(allFinite(picture));
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        for (const FilmPixel& pixel : picture.pixels) ASSERT_EQ(pixel.mean[channel], expected);
    };
    const Picture clear = throughBall(device, {0.2f, 0.5f, 1}, INFINITY, 1);
    for (const size_t channel : {0, 1, 2}) expectEach(clear, channel, 1);

    // A component of 0 lets nothing through, however short the way is; one of 1 all.
    Scene scene = absorbing({0, 0.5f, 1}, 1, 1);
    const Picture picture = render(device, scene, cameraAt({0, 0, 3}, {0, 0, 0}, 0.1),
                                   {.size = 8, .samples = 8, .maxBounces = 4, .rouletteStart = 8});
    expectEach(picture, 0, 0);
    expectEach(picture, 2, 1);
    // Through the middle of the ball, but for what its flat sides cut off.
    const Picture middle = render(device, scene, cameraAt({0, 0, 3}, {0, 0, 0}, 1e-4),
                                  {.size = 8, .samples = 8, .maxBounces = 4, .rouletteStart = 8});
    EXPECT_NEAR(meanOf(middle, 1).value, std::pow(0.5, 2), 1e-3);
}

TEST_F(HardLimits, HardCase30_AbsorptionScalesWithTheScene) {
    const Picture one = throughBall(device, {0.2f, 0.5f, 0.9f}, 1, 1);
    for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
        SCOPED_TRACE(scale);
        EXPECT_LE(relMse(throughBall(device, {0.2f, 0.5f, 0.9f}, scale, scale), one), 1e-6);
    }
}

// ---- 44

/// A room with a lamp and with a tinier, brighter one, whose light makes bright samples.
Scene litRoom() {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}));
    addMesh(scene, quadMesh({-0.6f, 0.99f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1.2f}),
            matte(glm::vec3(0), glm::vec3(4)));
    addMesh(scene, quadMesh({0.9f, -0.9f, -0.9f}, {0.02f, 0, 0}, {0, 0, 0.02f}),
            matte(glm::vec3(0), glm::vec3(3000)));
    scene.materials.back().doubleSided = true;
    return scene;
}

double luminanceOf(const Picture& picture) {
    double sum = 0;
    for (const FilmPixel& pixel : picture.pixels) sum += pixel.luminance();
    return sum;
}

TEST_F(HardLimits, HardCase44_ClampsReportTheEnergyThatTheyRemove) {
    EXPECT_EQ(RenderSettings{}.clampDirect, 0);
    EXPECT_EQ(RenderSettings{}.clampIndirect, 0);
    EXPECT_EQ(RenderSettings{}.regularisation, 0);
    const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    Shot shot{.size = 24, .samples = 64, .maxBounces = 5};
    const Picture reference = render(device, litRoom(), camera, shot);
    EXPECT_EQ(reference.stats.faults.clampedSamples, 0u);
    EXPECT_EQ(reference.stats.faults.clampedLuminance, 0);
    double least = 1;
    for (const auto& [direct, indirect] : {std::pair{0.0, 0.5}, {0.5, 0.0}, {0.3, 0.1}}) {
        SCOPED_TRACE(testing::Message() << direct << " and " << indirect);
        shot.clampDirect = direct;
        shot.clampIndirect = indirect;
        const Picture bounded = render(device, litRoom(), camera, shot);
        // A bound steers no path: at equal seeds what is missing from the picture is what was taken away.
        const double total = luminanceOf(reference), missing = (total - luminanceOf(bounded)) / total;
        const double reported = bounded.stats.faults.clampedLuminance / shot.samples / total;
        recordWorst("removed_percent", 100 * reported);
        recordWorst("misreported", std::abs(reported - missing));
        EXPECT_GT(bounded.stats.faults.clampedSamples, 0u);
        EXPECT_NEAR(reported, missing, 1e-5) << "share of the energy";
        least = std::min(least, reported);
    }
    EXPECT_GT(least, 1e-3) << "a bound that removes nothing tests nothing";
}

TEST_F(HardLimits, HardCase44_RegularisationMovesLightAndRemovesNone) {
    // White metals under a white sky: whatever a regularised path does, it ends with radiance 1.
    Scene scene;
    addMesh(scene, quadMesh({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}), matte(glm::vec3(1)));
    Material mirror;
    mirror.roughness = 0;
    addMesh(scene, cubeMesh(false), mirror,
            glm::scale(glm::translate(glm::dmat4(1), {0, -0.4, 0}), glm::dvec3(0.5)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    for (const double regularisation : {0.0, 0.1, 0.3}) {
        const Mean mean =
            meanOf(render(device, scene, cameraAt({0, 1, 4}, {0, -0.3, 0}, 0.7),
                          {.size = 24, .samples = 64, .maxBounces = 64, .regularisation = regularisation}));
        SCOPED_TRACE(regularisation);
        expectMean(mean, 1, 5e-3);
    }
}

TEST_F(HardLimits, HardCase44_RegularisationChangesTheMeanOfARoomByLittle) {
    // Nothing counts what it does within a path: paths go elsewhere. What a user compares are two pictures.
    Scene scene = litRoom();
    Material glass;
    glass.metallic = 0;
    glass.roughness = 0;
    glass.transmission = 1;
    glass.thickness = 1;
    addMesh(scene, sphereMesh(24), glass,
            glm::scale(glm::translate(glm::dmat4(1), {0.3, -0.6, 0}), glm::dvec3(0.4)));
    const Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    Shot shot{.size = 24, .samples = 128, .maxBounces = 6};
    const Picture reference = render(device, scene, camera, shot);
    shot.regularisation = 0.3;
    const Picture blurred = render(device, scene, camera, shot);
    const double total = luminanceOf(reference), change = std::abs(luminanceOf(blurred) - total) / total;
    recordWorst("changed_percent", 100 * change);
    EXPECT_LT(change, 0.05);
    EXPECT_GT(relMse(blurred, reference), 1e-4) << "one that does nothing tests nothing";
}

// ---- 47

TEST_F(HardLimits, HardCase47_AnApertureTowardsNothingIsAPinhole) {
    Camera camera = cameraAt({0, -0.3, 0.95}, {0, -0.6, -0.2}, 1.4);
    const Shot shot{.size = 24, .samples = 16, .maxBounces = 3};
    const Picture pinhole = render(device, litRoom(), camera, shot);
    camera.focusDistance = 1;
    camera.apertureRadius = 1e-9f;
    const double off = relMse(render(device, litRoom(), camera, shot), pinhole);
    recordWorst("pinhole", off);
    EXPECT_LE(off, 1e-4);
    camera.apertureRadius = 0.3f;
    EXPECT_GT(relMse(render(device, litRoom(), camera, shot), pinhole), 1e-3) << "a lens that is one blurs";
}

TEST_F(HardLimits, HardCase47_FocusNextToTheLensIsFinite) {
    for (const double degrees : {0.05, 60.0, 179.0})
        for (const float focus : {1e-6f, 1e-3f}) {
            Camera camera = cameraAt({0, 0, 0.5}, {0, 0, -1}, glm::radians(degrees));
            camera.apertureRadius = 0.01f;
            camera.focusDistance = focus;
            const Picture picture = render(device, litRoom(), camera, {.size = 16, .samples = 16});
            EXPECT_TRUE(allFinite(picture)) << degrees << " focus " << focus;
            EXPECT_EQ(picture.stats.droppedSamples, 0u);
            EXPECT_GT(meanOf(picture).value, 0);
        }
}

}  // namespace
}  // namespace tilefarm
