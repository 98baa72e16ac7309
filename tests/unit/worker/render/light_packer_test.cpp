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

TEST(LightPacker, PowerCountsWhatIsThereOfACutOutEmitter) {
    // Two squares: an opaque one and one of alpha 0.25.
    Scene scene = emissiveSquare(1, glm::vec3(1));
    Scene other = emissiveSquare(1, glm::vec3(1));
    other.materials[0].alphaMode = AlphaMode::blend;
    other.materials[0].alpha = 0.5f;
    other.meshes[0].colors.assign(4, {1, 1, 1, 0.5f});
    other.meshes[0].material = 1;
    scene.materials.push_back(other.materials[0]);
    scene.meshes.push_back(other.meshes[0]);
    scene.instances.push_back({1, glm::dmat4(1), "second"});
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    ASSERT_EQ(lights.records.size(), 4u);
    EXPECT_NEAR(lights.records[0].pmf, 0.5 / 1.25, 1e-6);
    EXPECT_NEAR(lights.records[2].pmf, 0.125 / 1.25, 1e-6);
}

TEST(LightPacker, WhatIsCutAwayIsNoLight) {
    Scene scene = emissiveSquare(1, glm::vec3(1));
    scene.materials[0].alpha = 0.4f;
    EXPECT_EQ(packLights(scene, flatten(scene), 0).records.size(), 2u) << "opaque: alpha is not read";
    scene.materials[0].alphaMode = AlphaMode::mask;
    EXPECT_TRUE(packLights(scene, flatten(scene), 0).records.empty());
    scene.materials[0].alphaMode = AlphaMode::blend;
    scene.materials[0].alpha = 0;
    EXPECT_TRUE(packLights(scene, flatten(scene), 0).records.empty());
}

TEST(LightPacker, AnEvenVeilOfAShapeIsALight) {
    Scene scene;
    Material material;
    material.emission = glm::vec3(2);
    material.alphaMode = AlphaMode::blend;
    material.alpha = 0.25f;
    scene.materials = {material};
    Shape shape;
    shape.kind = ShapeKind::rectangle;
    scene.shapes = {shape};
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    ASSERT_EQ(lights.records.size(), 1u);
    EXPECT_FLOAT_EQ(lights.records[0].red, 0.5f);
    EXPECT_EQ(lights.counts.lights, 1u);
}

/// Squares at the nodes named by their index.
Scene squaresAt(const std::vector<uint32_t>& nodes) {
    Scene scene = emissiveSquare(1, glm::vec3(1));
    scene.instances.clear();
    for (const uint32_t node : nodes) {
        Instance instance;
        instance.nodeIndex = node;
        instance.toWorld[3].x = 3.0 * static_cast<double>(scene.instances.size());
        scene.instances.push_back(instance);
    }
    return scene;
}

TEST(LightPacker, AllAsksOneEmitterOfEachNode) {
    Scene scene = squaresAt({4, 4, 7});
    scene.lights = {pointLight(1)};
    const PackedLights lights = packLights(scene, flatten(scene), 0, LightSelection::all);
    ASSERT_EQ(lights.records.size(), 7u);
    EXPECT_EQ(lights.groups, 3u);
    for (const auto& [group, first] : {std::pair{0u, 0u}, {1u, 4u}, {2u, 6u}})
        EXPECT_EQ(lights.alias[group].trail, first);
    const float expected[]{0.25f, 0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 1};
    for (size_t i = 0; i < lights.records.size(); ++i)
        EXPECT_NEAR(lights.records[i].pmf, expected[i], 1e-6) << i;
    for (uint32_t i = 4; i < 6; ++i) EXPECT_TRUE(lights.alias[i].alias == 4 || lights.alias[i].alias == 5);
    EXPECT_EQ(lights.counts.lights, 3u);
    EXPECT_EQ(lights.counts.emissiveGroups, 2u);
    EXPECT_EQ(lights.counts.emissiveTriangles, 6u);
}

TEST(LightPacker, OneLampIsChosenFromByPower) {
    const Scene scene = squaresAt({4, 4});
    const PackedLights lights = packLights(scene, flatten(scene), 0, LightSelection::all);
    EXPECT_EQ(lights.groups, 0u);
    EXPECT_EQ(lights.features, gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES));
    EXPECT_NEAR(sumOfPmf(lights), 1, 1e-6);
}

TEST(LightPacker, CountsWhatShinesAndNothingElse) {
    Scene scene = squaresAt({0});
    scene.lights = {pointLight(0), pointLight(2)};
    const PackedLights lights = packLights(scene, flatten(scene), 5);
    EXPECT_EQ(lights.counts.lights, 2u) << "a lamp and a square; not the dark lamp nor the environment";
}

}  // namespace
}  // namespace tilefarm
