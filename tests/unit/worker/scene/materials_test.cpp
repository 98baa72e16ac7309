#include "worker/scene/materials.h"

#include <gmock/gmock.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct MaterialsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();

    MaterialsTest() {
        const auto png = encodePng(2, 1, 4, 8, {10, 20, 30, 40, 50, 60, 70, 80});
        builder.set("/images/0/bufferView", builder.view(png)).set("/images/0/mimeType", R"("image/png")");
        builder.set("/textures/0/source", 0);
    }
    Scene load() { return loadGltf(builder.writeGltf(folder.path())); }
    Material material() { return load().materials.at(0); }
    std::string fault() {
        return errorOf([&] { load(); }).what();
    }
};

TEST_F(MaterialsTest, HasTheDefaultsOfTheSpecification) {
    const Material m = material();
    EXPECT_EQ(m.baseColor, glm::vec3(1));
    EXPECT_EQ(m.alpha, 1);
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.emission, glm::vec3(0));
    EXPECT_EQ(m.alphaMode, AlphaMode::opaque);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.transmission, 0);
    EXPECT_FALSE(m.baseColorTexture);
    EXPECT_FALSE(m.doubleSided);
}

TEST_F(MaterialsTest, ReadsEveryFactor) {
    builder.set("/materials/0",
                R"({"name": "All", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6},
        "emissiveFactor": [1, 0.5, 0], "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 100}, "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_unlit": {}, "KHR_materials_transmission": {"transmissionFactor": 0.9},
            "KHR_materials_volume": {"thicknessFactor": 2, "attenuationDistance": 3,
                                     "attenuationColor": [0.7, 0.8, 0.9]}}})");
    const Material m = material();
    EXPECT_EQ(m.name, "All");
    EXPECT_EQ(m.baseColor, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.alpha, 0.4f);
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.6f);
    EXPECT_EQ(m.emission, glm::vec3(100, 50, 0));
    EXPECT_EQ(m.alphaMode, AlphaMode::mask);
    EXPECT_EQ(m.alphaCutoff, 0.25f);
    EXPECT_TRUE(m.doubleSided);
    EXPECT_TRUE(m.unlit);
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_EQ(m.transmission, 0.9f);
    EXPECT_EQ(m.thickness, 2);
    EXPECT_EQ(m.attenuationDistance, 3);
    EXPECT_EQ(m.attenuationColor, glm::vec3(0.7f, 0.8f, 0.9f));
}

TEST_F(MaterialsTest, ReadsEveryTextureAndLoadsASharedImageOnce) {
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "metallicRoughnessTexture": {"index": 0, "texCoord": 1}}, "normalTexture": {"index": 0, "scale": -2},
        "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}}}})");
    const Scene scene = load();
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_THAT(scene.images[0].rgba8, ElementsAre(10, 20, 30, 40, 50, 60, 70, 80));
    const Material& m = scene.materials[0];
    EXPECT_TRUE(m.baseColorTexture.srgb);
    EXPECT_FALSE(m.metallicRoughnessTexture.srgb);
    EXPECT_EQ(m.metallicRoughnessTexture.uvSet, 1u);
    EXPECT_FALSE(m.normalTexture.srgb);
    EXPECT_EQ(m.normalScale, -2);
    EXPECT_TRUE(m.emissionTexture.srgb);
    EXPECT_EQ(m.transmissionTexture.image, 0u);
    EXPECT_EQ(scene.meshes[0].tangents.size(), 4u) << "a normal map asks for tangents";
}

TEST_F(MaterialsTest, LoadsImagesOfUsedMaterialsOnly) {
    builder.set("/materials/1", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})");
    const Scene scene = load();
    EXPECT_TRUE(scene.images.empty());
    EXPECT_FALSE(scene.materials[1].baseColorTexture);
}

TEST_F(MaterialsTest, ReadsSamplers) {
    builder.set("/samplers/0", R"({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987})");
    builder.set("/textures/0/sampler", 0);
    builder.set("/materials/0", R"({"normalTexture": {"index": 0}})");
    const TextureRef ref = material().normalTexture;
    EXPECT_EQ(ref.wrapS, Wrap::clamp);
    EXPECT_EQ(ref.wrapT, Wrap::mirror);
    EXPECT_FALSE(ref.linearFilter);
    builder.set("/samplers/0/wrapS", "1");
    EXPECT_THAT(fault(), HasSubstr("/samplers/0/wrapS: is 1"));
    builder.set("/textures/0/sampler", 3);
    EXPECT_THAT(fault(), HasSubstr("/textures/0/sampler: refers to /samplers/3"));
}

TEST_F(MaterialsTest, TransformsTextureCoordinatesAsTheExtensionsExampleDoes) {
    // "only the lower left quadrant of the source image, rotated clockwise 90 degrees"
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0,
        "extensions": {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1.5707963267948966,
                                                 "scale": [0.5, 0.5], "texCoord": 1}}}}})");
    const TextureRef ref = material().baseColorTexture;
    EXPECT_EQ(ref.uvSet, 1u) << "the extension's set wins";
    const auto at = [&](float u, float v) { return ref.transform * glm::vec3(u, v, 1); };
    for (const auto& [uv, expected] : {std::pair(glm::vec2(0, 0), glm::vec2(0, 1)),
                                       {{1, 0}, {0, 0.5f}},
                                       {{0, 1}, {0.5f, 1}},
                                       {{1, 1}, {0.5f, 0.5f}}}) {
        EXPECT_NEAR(glm::length(at(uv.x, uv.y) - expected), 0, 1e-6);
    }
}

TEST_F(MaterialsTest, WarnsOfMoreThanTwoTextureCoordinateSets) {
    builder.set("/materials/0", R"({"name": "Deep", "normalTexture": {"index": 0, "texCoord": 2}})");
    const Scene scene = load();
    EXPECT_FALSE(scene.materials[0].normalTexture);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "TEXCOORD_2");
    EXPECT_EQ(scene.warnings[0].where, "materials/0/normalTexture");
}

TEST_F(MaterialsTest, KeepsSixteenBitsAsLinearFloats) {
    const auto png = encodePng(1, 1, 3, 16, {65535, 13107, 257});
    builder.set("/images/0/bufferView", builder.view(png));
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
                                    "normalTexture": {"index": 0}})");
    const Scene scene = load();
    ASSERT_EQ(scene.images.size(), 2u) << "read once as colours and once as data";
    const Material& m = scene.materials[0];
    EXPECT_FALSE(m.baseColorTexture.srgb) << "decoded already";
    const std::vector<float>& color = scene.images[m.baseColorTexture.image].rgbaFloat;
    EXPECT_EQ(color[0], 1);
    EXPECT_NEAR(color[1], 0.033104767, 1e-7) << "0.2 by IEC 61966-2-1";
    const std::vector<float>& data = scene.images[m.normalTexture.image].rgbaFloat;
    EXPECT_THAT(data, ElementsAre(1, 0.2f, 257 / 65535.0f, 1));
}

TEST_F(MaterialsTest, NamesImagesThatCannotBeRead) {
    builder.set("/materials/0", R"({"normalTexture": {"index": 0}})");
    const std::vector<std::byte> junk(50, std::byte{7});
    builder.set("/images/0/bufferView", builder.view(junk));
    EXPECT_THAT(fault(), HasSubstr("/images/0: the image cannot be decoded"));
    builder.set("/images/0", R"({"uri": "absent.png"})");
    EXPECT_THAT(fault(), HasSubstr("/images/0/uri: "));
    builder.set("/images/0", "{}");
    EXPECT_THAT(fault(), HasSubstr("/images/0/uri: is missing"));
    builder.set("/textures/0/source", 4);
    builder.set("/images/0", R"({"uri": "absent.png"})");
    EXPECT_THAT(fault(), HasSubstr("/textures/0/source: refers to /images/4"));
}

TEST_F(MaterialsTest, RefusesAnImageThatClaimsToBeEnormous) {
    auto png = encodePng(2, 1, 4, 8, std::vector<uint16_t>(8));
    png[16] = std::byte{0x7f};  // the width's high byte
    builder.set("/materials/0", R"({"normalTexture": {"index": 0}})")
        .set("/images/0/bufferView", builder.view(png));
    EXPECT_THAT(fault(), HasSubstr("/images/0: the image"));
}

TEST_F(MaterialsTest, TextureFormatsItDoesNotKnowFallBackOrAreLeftOut) {
    builder.set("/materials/0", R"({"normalTexture": {"index": 0}})");
    builder.set("/textures/0", R"({"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}})");
    EXPECT_TRUE(material().normalTexture);
    builder.set("/textures/0", R"({"extensions": {"KHR_texture_basisu": {"source": 1}}})");
    const Scene scene = load();
    EXPECT_FALSE(scene.materials[0].normalTexture);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "KHR_texture_basisu");
    EXPECT_EQ(scene.warnings[0].where, "textures/0");
}

TEST_F(MaterialsTest, WarnsOfWhatIsNotRendered) {
    builder.set(
        "/materials/0",
        R"({"name": "Milk", "extensions": {"KHR_materials_volume_scatter": {}, "KHR_materials_sheen": {}}})");
    const Scene scene = load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "KHR_materials_volume_scatter");
    EXPECT_EQ(scene.warnings[0].where, "materials/0 (Milk)");
    EXPECT_EQ(scene.warnings[0].instead, "rendered with absorption alone");
}

TEST_F(MaterialsTest, ClampsFactorsOutOfRangeWithAWarning) {
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"roughnessFactor": 1.5},
                                    "extensions": {"KHR_materials_ior": {"ior": 0.5}}})");
    const Scene scene = load();
    EXPECT_EQ(scene.materials[0].roughness, 1);
    EXPECT_EQ(scene.materials[0].ior, 1);
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.warnings[0].feature, "ior");
    EXPECT_EQ(scene.warnings[1].feature, "roughnessFactor");
}

TEST_F(MaterialsTest, RefusesWhatCannotBeUnderstood) {
    struct Case {
        const char *json, *fault;
    };
    for (const Case& c :
         {Case{R"({"alphaMode": "GLASS"})", "/materials/0/alphaMode: is \"GLASS\""},
          Case{R"({"emissiveFactor": [1, 1]})", "/materials/0/emissiveFactor: must have 3 numbers, has 2"},
          Case{R"({"doubleSided": 1})", "/materials/0/doubleSided: must be true or false, is number"},
          Case{R"({"normalTexture": {"index": 1}})",
               "/materials/0/normalTexture/index: refers to /textures/1"},
          Case{R"({"normalTexture": {}})", "/materials/0/normalTexture/index: is missing"},
          Case{R"({"extensions": {"KHR_materials_volume": {"attenuationDistance": 0}}})",
               "/materials/0/extensions/KHR_materials_volume/attenuationDistance: must be greater than 0"}}) {
        builder.set("/materials/0", c.json);
        EXPECT_THAT(fault(), HasSubstr(c.fault));
    }
}

}  // namespace
}  // namespace tilefarm
