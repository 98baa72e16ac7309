#include "worker/render/camera_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace tilefarm {
namespace {

TEST(CameraParameters, KeepTheVerticalFieldOfViewWhateverTheAspect) {
    Camera camera;
    camera.yfov = 1;
    camera.aspect = 1;
    ImageSpec image;
    image.width = 300;
    image.height = 100;
    gpu::FrameParameters p{};
    setCamera(p, camera, image);
    EXPECT_NEAR(p.cameraUp.y, std::tan(0.5), 1e-6);
    EXPECT_NEAR(p.cameraRight.x, 3 * std::tan(0.5), 1e-6);
    EXPECT_FLOAT_EQ(p.cameraForward.z, -1);
    EXPECT_EQ(p.cameraKind, 0);
}

TEST(CameraParameters, IgnoreTheScaleOfTheCamerasNode) {
    Camera camera;
    camera.toWorld = glm::scale(glm::dmat4(1), glm::dvec3(10, 20, 30));
    gpu::FrameParameters scaled{}, plain{};
    const ImageSpec image{.width = 300, .height = 100};
    setCamera(scaled, camera, image);
    setCamera(plain, Camera{}, image);
    EXPECT_EQ(scaled.cameraUp, plain.cameraUp);
    EXPECT_EQ(scaled.cameraRight, plain.cameraRight);
    EXPECT_EQ(scaled.cameraForward, plain.cameraForward);
}

TEST(CameraParameters, OrthographicAxesAreInMetres) {
    Camera camera;
    camera.orthographic = true;
    camera.ymag = 3;
    ImageSpec image;
    image.width = 200;
    image.height = 100;
    gpu::FrameParameters p{};
    setCamera(p, camera, image);
    EXPECT_EQ(p.cameraKind, 1);
    EXPECT_FLOAT_EQ(p.cameraUp.y, 3);
    EXPECT_FLOAT_EQ(p.cameraRight.x, 6);
}

}  // namespace
}  // namespace tilefarm
