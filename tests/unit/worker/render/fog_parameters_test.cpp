#include "worker/render/fog_parameters.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace tilefarm {
namespace {

WorldGeometry unitTriangleAround(const glm::dvec3& centre) {
    WorldGeometry world;
    world.centre = centre;
    world.lower = {-1, -2, -3};
    world.upper = {1, 2, 3};
    world.triangles = {{0, 1, 2}};
    return world;
}

CameraPath cameraAtZ(double z) {
    Camera camera;
    camera.toWorld = glm::translate(glm::dmat4(1), {0, 0, z});
    camera.apertureRadius = 0.5f;
    return {{camera}, std::nullopt};
}

Fog thinFog() {
    Fog fog;
    fog.extinction = {1, 2, 4};
    fog.albedo = {1, 0.5, 0};
    fog.anisotropy = -0.25;
    return fog;
}

TEST(FogParameters, SplitExtinctionIntoScatteringAndAbsorption) {
    gpu::FrameParameters p{};
    setFog(p, placeFog(thinFog(), unitTriangleAround({})), cameraAtZ(0));
    EXPECT_EQ(glm::vec3(p.fogScattering), glm::vec3(1, 1, 0));
    EXPECT_EQ(glm::vec3(p.fogAbsorption), glm::vec3(0, 1, 4));
    EXPECT_EQ(p.fogAnisotropy, -0.25f);
    EXPECT_EQ(p.fogPresent, 1);
}

TEST(FogParameters, FillTheBoxAroundSurfacesAndCameraUnlessGivenOne) {
    gpu::FrameParameters p{};
    setFog(p, placeFog(thinFog(), unitTriangleAround({100, 0, 0})), cameraAtZ(10));
    EXPECT_EQ(glm::vec3(p.fogLower), glm::vec3(-1, -2, -3));
    EXPECT_EQ(glm::vec3(p.fogUpper), glm::vec3(1, 2, 10.5f)) << "the lens included";

    Fog boxed = thinFog();
    boxed.box = Fog::Box{{99, 0, 0}, {101, 1, 1}};
    setFog(p, placeFog(boxed, unitTriangleAround({100, 0, 0})), cameraAtZ(10));
    EXPECT_EQ(glm::vec3(p.fogLower), glm::vec3(-1, 0, 0)) << "in the space of the geometry";
    EXPECT_EQ(glm::vec3(p.fogUpper), glm::vec3(1, 1, 1));
}

TEST(FogParameters, OfASceneWithoutFogStayZero) {
    gpu::FrameParameters p{};
    setFog(p, placeFog(Fog{}, unitTriangleAround({})), cameraAtZ(0));
    EXPECT_EQ(p.fogPresent, 0);
}

}  // namespace
}  // namespace tilefarm
