#include <gtest/gtest.h>

#include <functional>

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

bool litByDefault(Scene scene) {
    lightIfDark(scene);
    return scene.hasEnvironment();
}

/// A cube whose emission is 1, seen through what `change` makes of its material and the scene.
Scene emitter(const std::function<void(Scene&, Material&)>& change) {
    Scene scene = cube(glm::vec3(1));
    change(scene, scene.materials.back());
    return scene;
}

TextureRef image(Scene& scene, std::vector<uint8_t> rgba) {
    Image& added = scene.images.emplace_back();
    added.width = static_cast<uint32_t>(rgba.size() / 4), added.height = 1;
    added.rgba8 = std::move(rgba);
    TextureRef ref;
    ref.image = static_cast<uint32_t>(scene.images.size() - 1);
    return ref;
}

TEST(DefaultLight, IsNotSwitchedOffByWhatDoesNotShine) {
    Scene lamp = cube(glm::vec3(0)), black = lamp, panel = lamp, needle = lamp;
    lamp.lights.emplace_back().color = glm::vec3(0);
    panel.areaLights.emplace_back().radiance = glm::vec3(0);
    needle.lights.emplace_back().type = PunctualType::spot;
    needle.lights.back().outerCone = 0;
    for (const Scene& scene : {lamp, panel, needle}) EXPECT_TRUE(litByDefault(scene));

    Scene label = cube(glm::vec3(0));
    label.materials.emplace_back().unlit = true;
    label.meshes.push_back(label.meshes.back());
    label.meshes.back().material = static_cast<uint32_t>(label.materials.size() - 1);
    label.instances.push_back(label.instances.back());
    label.instances.back().mesh = static_cast<uint32_t>(label.meshes.size() - 1);
    EXPECT_TRUE(litByDefault(label)) << "a label beside what it does not light";
    EXPECT_TRUE(litByDefault(emitter([](Scene& s, Material& m) {
        m.emissionTexture = image(s, {0, 0, 0, 255, 0, 0, 0, 255});
    }))) << "a black map";
    EXPECT_TRUE(litByDefault(emitter([](Scene& s, Material& m) {
        m.emission = glm::vec3(1, 0, 0), m.emissionTexture = image(s, {0, 255, 255, 255});
    }))) << "a map without the channel that the factor keeps";
    EXPECT_TRUE(litByDefault(emitter([](Scene&, Material& m) {
        m.alphaMode = AlphaMode::blend, m.alpha = 0;
    }))) << "alpha 0";
    EXPECT_TRUE(litByDefault(emitter([](Scene& s, Material& m) {
        m.alphaMode = AlphaMode::mask, m.baseColorTexture = image(s, {255, 255, 255, 100});
    }))) << "all cut out";
    EXPECT_TRUE(litByDefault(emitter([](Scene& s, Material& m) {
        m.alphaMode = AlphaMode::blend;
        s.meshes.back().colors.assign(s.meshes.back().positions.size(), glm::vec4(1, 1, 1, 0));
    }))) << "alpha 0 at every vertex";
    EXPECT_TRUE(litByDefault(emitter([](Scene& s, Material&) {
        s.instances.back().toWorld = glm::dmat4(0);
    }))) << "no area";
}

TEST(DefaultLight, StaysOffWhereAllIsUnlit) {
    EXPECT_FALSE(litByDefault(emitter([](Scene&, Material& m) { m.unlit = true; })));
}

TEST(DefaultLight, LightsTheSharedCaseOfAnUnlitCard) {
    const std::filesystem::path file =
        std::filesystem::path(TILEFARM_SHARED_DATA) / "cases/mat-unlit-does-not-darken-others/a.gltf";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared data";
    EXPECT_TRUE(litByDefault(loadGltf(file)));
}

TEST(DefaultLight, IsSwitchedOffByWhatShinesAtAll) {
    EXPECT_FALSE(litByDefault(emitter([](Scene& s, Material& m) {
        m.emissionTexture = image(s, {0, 0, 0, 255, 0, 0, 1, 255});
    })));
    EXPECT_FALSE(litByDefault(emitter([](Scene&, Material& m) { m.alpha = 0; })))
        << "opaque: alpha says nothing";
    EXPECT_FALSE(litByDefault(emitter([](Scene& s, Material& m) {
        m.alphaMode = AlphaMode::mask, m.baseColorTexture = image(s, {0, 0, 0, 0, 0, 0, 0, 200});
    })));
    Scene fading = cube(glm::vec3(0));
    fading.lightChanges = true;
    EXPECT_FALSE(litByDefault(fading)) << "a lamp that an animation turns on later";
    Scene chosen = cube(glm::vec3(0));
    chosen.environment = uniformEnvironment(glm::vec3(0));
    lightIfDark(chosen);
    EXPECT_EQ(chosen.environment.image.rgbaFloat[0], 0) << "an environment is what was asked for";
}

}  // namespace
}  // namespace tilefarm
