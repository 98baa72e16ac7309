#include "worker/render/layer_packer.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/test_scenes.h"
#include "worker/render/material_packer.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

TextureRef texture() {
    TextureRef ref;
    ref.image = 0;
    return ref;
}

struct Packed {
    uint64_t features;
    gpu::MaterialRecord record;
    size_t tables;
};

Packed pack(const Material& material) {
    Scene scene;
    scene.images.push_back({"white", 1, 1, {255, 255, 255, 255}, {}});
    TexturePacker textures(scene);
    MaterialPacker packer(textures);
    packer.add(material, true);
    return {packer.features, packer.records[0],
            packer.albedoTables.size() / (gpu::ALBEDO_TABLE_SIZE * (gpu::ALBEDO_TABLE_SIZE + 1))};
}

TEST(LayerPacker, CallsForEachLobeByItsWeight) {
    EXPECT_EQ(pack(matte(glm::vec3(1))).features, 0u);
    const auto features = [](auto set) {
        Material m = matte(glm::vec3(1));
        set(m);
        return pack(m).features;
    };
    EXPECT_EQ(features([](Material& m) { m.clearcoat = 0.5f; }), gpu::bit(gpu::FEATURE_CLEARCOAT));
    EXPECT_EQ(features([](Material& m) { m.clearcoat = 1, m.clearcoatGtr1 = true; }),
              gpu::bit(gpu::FEATURE_CLEARCOAT) | gpu::bit(gpu::FEATURE_GTR1));
    EXPECT_EQ(features([](Material& m) { m.clearcoatGtr1 = true; }), 0u) << "no coat";
    EXPECT_EQ(features([](Material& m) { m.sheenColor = {0, 0, 1}; }), gpu::bit(gpu::FEATURE_SHEEN));
    EXPECT_EQ(features([](Material& m) { m.disneySheen = 1; }), gpu::bit(gpu::FEATURE_DISNEY_SHEEN));
    EXPECT_EQ(features([](Material& m) { m.subsurface = 1; }), gpu::bit(gpu::FEATURE_DISNEY_DIFFUSE));
    EXPECT_EQ(features([](Material& m) { m.orenNayarSigma = 0.3f; }), gpu::bit(gpu::FEATURE_OREN_NAYAR));
    EXPECT_EQ(features([](Material& m) { m.disneyDiffuse = true, m.orenNayarSigma = 0.3f; }),
              gpu::bit(gpu::FEATURE_DISNEY_DIFFUSE));
    EXPECT_EQ(features([](Material& m) { m.diffuseTransmission = 0.1f; }),
              gpu::bit(gpu::FEATURE_DIFFUSE_TRANSMISSION));
}

TEST(LayerPacker, MetalsHaveNoDiffuseBase) {
    Material metal = matte(glm::vec3(1));
    metal.metallic = 1;
    metal.orenNayarSigma = metal.diffuseTransmission = metal.disneySheen = 1;
    EXPECT_EQ(pack(metal).features,
              gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION));
    metal.metallicRoughnessTexture = texture();  // may leave parts that are not metal
    EXPECT_NE(pack(metal).features & gpu::bit(gpu::FEATURE_OREN_NAYAR), 0u);
}

TEST(LayerPacker, AttenuationNeedsASolidThatLightEnters) {
    Material wax = matte(glm::vec3(1));
    wax.diffuseTransmission = 1;
    wax.attenuationColor = {0.5f, 1, 1};
    wax.attenuationDistance = 1;
    EXPECT_EQ(pack(wax).features & gpu::bit(gpu::FEATURE_ATTENUATION), 0u);
    wax.thickness = 1;
    EXPECT_NE(pack(wax).features & gpu::bit(gpu::FEATURE_ATTENUATION), 0u);
}

TEST(LayerPacker, BindsTexturesAndTablesOnlyOfLobesThatShow) {
    Material m = matte(glm::vec3(1));
    m.clearcoatTexture = m.clearcoatNormalTexture = m.sheenColorTexture = m.diffuseTransmissionTexture =
        texture();
    Packed packed = pack(m);
    EXPECT_EQ(packed.features, 0u);
    EXPECT_EQ(packed.tables, 0u);
    EXPECT_EQ(packed.record.clearcoatTexture, gpu::NO_INDEX);
    EXPECT_EQ(packed.record.sheenColorTexture, gpu::NO_INDEX);
    EXPECT_EQ(packed.record.diffuseTransmissionTexture, gpu::NO_INDEX);
    m.clearcoat = 1;
    m.sheenColor = glm::vec3(1);
    m.diffuseTransmission = 1;
    packed = pack(m);
    EXPECT_NE(packed.features & gpu::bit(gpu::FEATURE_NORMAL_MAPS), 0u);
    EXPECT_NE(packed.features & gpu::bit(gpu::FEATURE_TEXTURES), 0u);
    EXPECT_NE(packed.record.clearcoatTexture, gpu::NO_INDEX);
    EXPECT_NE(packed.record.clearcoatNormalTexture, gpu::NO_INDEX);
    EXPECT_NE(packed.record.sheenColorTexture, gpu::NO_INDEX);
    EXPECT_NE(packed.record.diffuseTransmissionTexture, gpu::NO_INDEX);
    EXPECT_EQ(packed.tables, 2u);
    EXPECT_NE(packed.record.coatTable, packed.record.sheenTable);
}

// tests/data/make_materials.py: the scenes hold what the pictures in the documents are to show.
TEST(LayerPacker, OurScenesCallForTheLobesTheyShow) {
    const auto featuresOf = [](const char* name) {
        const Scene scene = loadGltf(std::filesystem::path(TILEFARM_SOURCE_DIR) / "tests/data" / name);
        TexturePacker textures(scene);
        MaterialPacker packer(textures);
        for (const Material& material : scene.materials) packer.add(material, true);
        return packer.features;
    };
    const uint64_t layers = gpu::bit(gpu::FEATURE_CLEARCOAT) | gpu::bit(gpu::FEATURE_SHEEN) |
                            gpu::bit(gpu::FEATURE_DIFFUSE_TRANSMISSION) | gpu::bit(gpu::FEATURE_ATTENUATION);
    const uint64_t maps = gpu::bit(gpu::FEATURE_TEXTURES) | gpu::bit(gpu::FEATURE_NORMAL_MAPS);
    EXPECT_EQ(featuresOf("materials.glb") & layers, layers);
    EXPECT_EQ(featuresOf("layers.glb") & (layers | maps), layers | maps);
}

}  // namespace
}  // namespace tilefarm
