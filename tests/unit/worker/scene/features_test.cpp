#include "worker/scene/features.h"

#include <gmock/gmock.h>

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// One double-sided dielectric triangle with a mirror's roughness: calls for as little as can be.
Scene plainScene() {
    Scene scene;
    Material material;
    material.metallic = 0;
    material.doubleSided = true;
    scene.materials = {material, Material{}};
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    scene.meshes = {mesh};
    scene.instances = {{0, glm::dmat4(1), "node"}};
    return scene;
}

std::vector<std::string> featuresOf(const Scene& scene) {
    return featureNames(detectFeatures(scene));
}

uint32_t addImage(Scene& scene, std::vector<uint8_t> rgba8) {
    Image image;
    image.width = static_cast<uint32_t>(rgba8.size() / 4);
    image.height = 1;
    image.rgba8 = std::move(rgba8);
    scene.images.push_back(image);
    return static_cast<uint32_t>(scene.images.size() - 1);
}

TEST(Features, OfAPlainSceneAreFew) {
    EXPECT_THAT(featuresOf(plainScene()), ElementsAre("roughReflection"));
}

TEST(Features, OfWhatNoInstanceShowsDoNotCount) {
    Scene scene = plainScene();
    scene.materials[1].transmission = 1;
    scene.materials[1].emission = {1, 1, 1};
    EXPECT_THAT(featuresOf(scene), ElementsAre("roughReflection"));
    scene.instances.clear();
    EXPECT_THAT(featuresOf(scene), IsEmpty());
}

TEST(Features, TellMirrorsFromRoughSurfacesByFactorAndTexture) {
    Scene scene = plainScene();
    scene.materials[0].roughness = 0.03f;  // alpha 9e-4
    EXPECT_THAT(featuresOf(scene), ElementsAre("smoothMirror"));
    scene.materials[0].roughness = 1;
    scene.materials[0].metallic = 1;
    scene.materials[0].metallicRoughnessTexture.image = addImage(scene, {9, 0, 0, 9, 9, 200, 0, 9});
    EXPECT_THAT(featuresOf(scene), ElementsAre("textures", "roughReflection", "smoothMirror"))
        << "blue is 0: no metal";
}

TEST(Features, KnowAlphaByWhatItCanBe) {
    Scene scene = plainScene();
    scene.materials[0].alphaMode = AlphaMode::blend;
    EXPECT_THAT(featuresOf(scene), ElementsAre("roughReflection")) << "alpha is 1 everywhere";
    scene.meshes[0].colors.assign(3, {1, 1, 1, 0.5f});
    EXPECT_THAT(featuresOf(scene), ElementsAre("vertexColors", "alphaBlend", "roughReflection"));
    scene.materials[0].alphaMode = AlphaMode::mask;
    EXPECT_THAT(featuresOf(scene), ElementsAre("vertexColors", "roughReflection"))
        << "0.5 is not below the cutoff";
    scene.materials[0].baseColorTexture.image = addImage(scene, {9, 9, 9, 255, 9, 9, 9, 254});
    EXPECT_THAT(featuresOf(scene), ElementsAre("textures", "vertexColors", "alphaMask", "roughReflection"));
}

TEST(Features, TellThinWallsFromColouredSolids) {
    Scene scene = plainScene();
    scene.materials[0].transmission = 1;
    EXPECT_THAT(featuresOf(scene), ElementsAre("roughReflection", "transmission", "thinWalled"));
    scene.materials[0].thickness = 1;
    EXPECT_THAT(featuresOf(scene), ElementsAre("roughReflection", "transmission"));
    scene.materials[0].attenuationDistance = 2;
    scene.materials[0].attenuationColor = {1, 0.5f, 1};
    EXPECT_THAT(featuresOf(scene), ElementsAre("roughReflection", "transmission", "volumeAttenuation"));
}

TEST(Features, ListLightsTexturesAndTheRest) {
    Scene scene = plainScene();
    Material& material = scene.materials[0];
    material.doubleSided = false;
    material.emission = {1, 0, 0};
    material.emissionTexture.image = material.normalTexture.image = addImage(scene, {1, 2, 3, 4});
    material.emissionTexture.uvSet = 1;
    material.normalTexture.transform[2] = {0.5f, 0};
    scene.meshes[0].normals.assign(3, {0, 0, 1});
    scene.lights.resize(3);
    scene.lights[1].type = PunctualType::spot;
    scene.lights[2].type = PunctualType::directional;
    scene.lights[2].color = {0, 0, 0};
    scene.environment.image.width = 1;
    EXPECT_THAT(featuresOf(scene),
                ElementsAre("textures", "uvSet1", "textureTransform", "normalMaps", "smoothNormals",
                            "singleSided", "roughReflection", "emissiveTriangles", "emissiveTextures",
                            "pointLights", "spotLights", "environment"));
    material = Material{};
    material.unlit = true;
    scene.lights.clear();
    scene.environment = {};
    EXPECT_THAT(featuresOf(scene), ElementsAre("smoothNormals", "singleSided", "unlit"));
}

}  // namespace
}  // namespace tilefarm
