#include "worker/render/light_packer.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

namespace tilefarm {
namespace {

// A unit square of two triangles that emits, scaled to `size`.
Scene emissiveSquare(float size, const glm::vec3& emission) {
    Scene scene;
    Material material;
    material.emission = emission;
    scene.materials.push_back(material);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, size, 0}};
    mesh.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.meshes.push_back(mesh);
    scene.instances.push_back({});
    return scene;
}

PunctualLight pointLight(float intensity) {
    PunctualLight light;
    light.color = glm::vec3(intensity);
    return light;
}

float sumOfPmf(const PackedLights& lights) {
    return std::accumulate(lights.records.begin(), lights.records.end(), 0.f,
                           [](float sum, const gpu::LightRecord& l) { return sum + l.pmf; });
}

TEST(LightPacker, ChoosesByPower) {
    Scene scene = emissiveSquare(2, glm::vec3(3));  // power 3 · 4 · π
    scene.lights.push_back(pointLight(1));          // power 4 π
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    ASSERT_EQ(lights.records.size(), 3u);
    EXPECT_NEAR(lights.records[2].pmf, 4.0 / (4 + 12), 1e-6);
    EXPECT_NEAR(sumOfPmf(lights), 1, 1e-6);
    EXPECT_EQ(lights.features,
              gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES) | gpu::bit(gpu::FEATURE_PUNCTUAL_LIGHTS));
}

TEST(LightPacker, TrianglesKnowTheirLight) {
    const Scene scene = emissiveSquare(1, glm::vec3(1));
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    ASSERT_EQ(lights.primitiveLights.size(), 2u);
    for (uint32_t primitive = 0; primitive < 2; ++primitive)
        EXPECT_EQ(lights.records[lights.primitiveLights[primitive]].primitive, primitive);
}

TEST(LightPacker, LeavesOutTrianglesWhoseTextureIsBlackThere) {
    Scene scene = emissiveSquare(1, glm::vec3(1));
    scene.images.push_back({"black", 1, 1, {0, 0, 0, 255}, {}});
    scene.materials[0].emissionTexture.image = 0;
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    EXPECT_TRUE(lights.records.empty());
    EXPECT_EQ(lights.darkTriangles, 2u);
    EXPECT_EQ(lights.primitiveLights, std::vector<uint32_t>(2, gpu::NO_INDEX));
}

TEST(LightPacker, KeepsPowersOfVeryDifferentSizeFinite) {
    Scene scene = emissiveSquare(1, glm::vec3(0));
    scene.lights = {pointLight(1e-30f), pointLight(1e30f)};
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    EXPECT_NEAR(sumOfPmf(lights), 1, 1e-6);
}

TEST(LightPacker, AnEnvironmentIsOneLight) {
    const Scene scene = emissiveSquare(2, glm::vec3(0));
    const PackedLights lights = packLights(scene, flatten(scene), 4 * std::numbers::pi);
    ASSERT_EQ(lights.records.size(), 1u);
    EXPECT_EQ(lights.environmentLight, 0u);
    EXPECT_FLOAT_EQ(lights.records[0].pmf, 1);
}

TEST(LightPacker, ASceneWithoutLightHasNone) {
    const Scene scene = emissiveSquare(2, glm::vec3(0));
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    EXPECT_TRUE(lights.records.empty());
    EXPECT_EQ(lights.features, 0u);
}

bool plantsATree(const Scene& scene, double environmentFlux) {
    const PackedLights lights = packLights(scene, flatten(scene), environmentFlux, LightSelection::tree);
    EXPECT_EQ(lights.tree.empty(), (lights.features & gpu::bit(gpu::FEATURE_LIGHT_TREE)) == 0);
    return !lights.tree.empty();
}

TEST(LightPacker, PlantsATreeWhereItIsWorthItsCost) {
    Scene scene = emissiveSquare(1, glm::vec3(1));
    EXPECT_FALSE(plantsATree(scene, 0)) << "two triangles";
    EXPECT_TRUE(plantsATree(scene, 10)) << "two triangles and an environment";
    scene.lights.assign(6, pointLight(1));
    EXPECT_TRUE(plantsATree(scene, 0)) << "eight lights";
    EXPECT_FALSE(plantsATree(emissiveSquare(1, glm::vec3(0)), 10)) << "an environment alone";
}

}  // namespace
}  // namespace tilefarm
