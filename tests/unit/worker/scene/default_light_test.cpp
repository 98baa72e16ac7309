#include <gtest/gtest.h>

#include "tests/support/test_scenes.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

Scene cube(const glm::vec3& emission) {
    Scene scene;
    addMesh(scene, cubeMesh(false), matte(glm::vec3(0.5f), emission));
    return scene;
}

TEST(DefaultLight, SurroundsADarkSceneAndSaysSo) {
    Scene scene = cube(glm::vec3(0));
    lightIfDark(scene);
    ASSERT_TRUE(scene.hasEnvironment());
    EXPECT_EQ(scene.environment.image.rgbaFloat[0], 1);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "lights");
}

TEST(DefaultLight, LeavesASceneWithAnyLightAlone) {
    Scene emissive = cube(glm::vec3(1)), punctual = cube(glm::vec3(0)), sky = cube(glm::vec3(0));
    punctual.lights.emplace_back();
    sky.environment = uniformEnvironment(glm::vec3(0.5f));
    for (Scene* scene : {&emissive, &punctual}) {
        lightIfDark(*scene);
        EXPECT_FALSE(scene->hasEnvironment());
        EXPECT_TRUE(scene->warnings.empty());
    }
    lightIfDark(sky);
    EXPECT_EQ(sky.environment.image.rgbaFloat[0], 0.5f);
}

}  // namespace
}  // namespace tilefarm
