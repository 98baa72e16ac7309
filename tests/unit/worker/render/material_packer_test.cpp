#include "worker/render/material_packer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/test_scenes.h"
namespace tilefarm {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

uint64_t featuresOf(const Material& material) {
    Scene scene;
    scene.images.push_back({"white", 1, 1, {255, 255, 255, 255}, {}});
    TexturePacker textures(scene);
    MaterialPacker packer(textures);
    packer.add(material, true);
    return packer.features;
}

TEST(Absorption, FollowsBeerLambert) {
    const glm::vec3 sigma = absorptionCoefficient({0.5f, 1, 0.25f}, 2);
    EXPECT_NEAR(std::exp(-2 * sigma.r), 0.5, 1e-6);
    EXPECT_EQ(sigma.g, 0);
    EXPECT_NEAR(std::exp(-2 * sigma.b), 0.25, 1e-6);
}

TEST(Absorption, IsZeroForAnInfiniteDistance) {
    EXPECT_EQ(absorptionCoefficient({0.1f, 0, 1}, kInfinity), glm::vec3(0));
}

TEST(Absorption, OfBlackIsFiniteAndTransmitsNothing) {
    const glm::vec3 sigma = absorptionCoefficient({0, 0, 0}, 0.01f);
    EXPECT_TRUE(std::isfinite(sigma.r));
    EXPECT_EQ(std::exp(-0.01f * sigma.r), 0);
}

TEST(MaterialPacker, CallsForNothingThatAMatteSurfaceLacks) {
    EXPECT_EQ(featuresOf(matte(glm::vec3(1))), 0u);
}

TEST(MaterialPacker, CallsForReflectionOnlyWhereThereIsSome) {
    Material metal = matte(glm::vec3(1));
    metal.metallic = 1;
    const uint64_t rough = gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
    EXPECT_EQ(featuresOf(metal), rough);
    metal.roughness = 0;
    EXPECT_EQ(featuresOf(metal), gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR));
    Material plastic = matte(glm::vec3(1));
    plastic.ior = 1.5f;
    EXPECT_EQ(featuresOf(plastic), rough);
    plastic.specular = 0;
    EXPECT_EQ(featuresOf(plastic), 0u);
}

TEST(MaterialPacker, CallsForAttenuationOnlyInsideColouredSolids) {
    Material glass = matte(glm::vec3(1));
    glass.transmission = 1;
    glass.ior = 1.5f;
    glass.attenuationColor = {0.5f, 1, 1};
    glass.attenuationDistance = 1;
    EXPECT_EQ(featuresOf(glass) & gpu::bit(gpu::FEATURE_ATTENUATION), 0u) << "thin-walled";
    glass.thickness = 1;
    EXPECT_NE(featuresOf(glass) & gpu::bit(gpu::FEATURE_ATTENUATION), 0u);
    glass.attenuationDistance = kInfinity;
    EXPECT_EQ(featuresOf(glass) & gpu::bit(gpu::FEATURE_ATTENUATION), 0u);
}

TEST(MaterialPacker, IgnoresMaterialsThatNothingUses) {
    Scene scene;
    TexturePacker textures(scene);
    MaterialPacker packer(textures);
    Material metal;
    packer.add(metal, false);
    packer.add(matte(glm::vec3(1)), true);
    EXPECT_EQ(packer.features, 0u);
    EXPECT_EQ(packer.records.size(), 2u);
    EXPECT_TRUE(packer.albedoTables.empty());
}

TEST(MaterialPacker, SharesOneAlbedoTablePerIndexOfRefraction) {
    Scene scene;
    TexturePacker textures(scene);
    MaterialPacker packer(textures);
    Material m;
    for (const float ior : {1.5f, 1.33f, 1.5f}) {
        m.ior = ior;
        packer.add(m, true);
    }
    EXPECT_EQ(packer.records[0].albedoTable, packer.records[2].albedoTable);
    EXPECT_NE(packer.records[0].albedoTable, packer.records[1].albedoTable);
    EXPECT_EQ(packer.albedoTables.size(), 2u * gpu::ALBEDO_TABLE_SIZE * (gpu::ALBEDO_TABLE_SIZE + 1));
}

}  // namespace
}  // namespace tilefarm
