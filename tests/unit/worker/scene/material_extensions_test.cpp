#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Texture 0 has two texels: (10, 20, 30, 40) and (50, 60, 70, 80); texture 1 has one: (200, 100, 50, 255).
struct MaterialExtensionsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();

    MaterialExtensionsTest() {
        addImage(encodePng(2, 1, 4, 8, {10, 20, 30, 40, 50, 60, 70, 80}));
        addImage(encodePng(1, 1, 4, 8, {200, 100, 50, 255}));
    }
    void addImage(const std::vector<std::byte>& png) {
        const std::string i = std::to_string(builder.size("/images"));
        builder.set("/images/" + i + "/bufferView", builder.view(png))
            .set("/images/" + i + "/mimeType", R"("image/png")");
        builder.set("/textures/" + i + "/source", i);
    }
    void extension(const std::string& name, const std::string& json) {
        builder.set("/materials/0/extensions/KHR_materials_" + name, json);
    }
    Scene load(const std::string& variant = {}) {
        return loadGltf(builder.writeGltf(folder.path()), variant);
    }
    Material material() { return load().materials.at(0); }
    std::string fault(const std::string& variant = {}) {
        return errorOf([&] { load(variant); }).what();
    }
};

TEST_F(MaterialExtensionsTest, HaveTheDefaultsOfTheirSpecifications) {
    for (const char* name : {"specular", "clearcoat", "sheen", "anisotropy", "iridescence", "dispersion",
                             "diffuse_transmission", "ior", "volume", "transmission"})
        extension(name, "{}");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.specular, 1);
    EXPECT_EQ(m.specularColor, glm::vec3(1));
    EXPECT_EQ(m.clearcoat, 0);
    EXPECT_EQ(m.clearcoatRoughness, 0);
    EXPECT_EQ(m.clearcoatNormalScale, 1);
    EXPECT_EQ(m.sheenColor, glm::vec3(0));
    EXPECT_EQ(m.sheenRoughness, 0);
    EXPECT_EQ(m.anisotropy, 0);
    EXPECT_EQ(m.anisotropyRotation, 0);
    EXPECT_EQ(m.iridescence, 0);
    EXPECT_EQ(m.iridescenceIor, 1.3f);
    EXPECT_EQ(m.iridescenceThicknessMinimum, 100);
    EXPECT_EQ(m.iridescenceThicknessMaximum, 400);
    EXPECT_EQ(m.dispersion, 0);
    EXPECT_EQ(m.diffuseTransmission, 0);
    EXPECT_EQ(m.diffuseTransmissionColor, glm::vec3(1));
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(MaterialExtensionsTest, ReadsSpecular) {
    extension("specular", R"({"specularFactor": 0.25, "specularTexture": {"index": 0},
        "specularColorFactor": [0.5, 1.5, 7], "specularColorTexture": {"index": 0, "texCoord": 1}})");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.specular, 0.25f);
    EXPECT_EQ(m.specularColor, glm::vec3(0.5f, 1.5f, 7)) << "colours above 1 are allowed";
    EXPECT_TRUE(m.specularTexture);
    EXPECT_FALSE(m.specularTexture.srgb);
    EXPECT_TRUE(m.specularColorTexture.srgb);
    EXPECT_EQ(m.specularColorTexture.uvSet, 1u);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.images.size(), 1u);
}

TEST_F(MaterialExtensionsTest, ReadsClearcoat) {
    extension("clearcoat", R"({"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 0},
        "clearcoatRoughnessFactor": 0.75, "clearcoatRoughnessTexture": {"index": 1},
        "clearcoatNormalTexture": {"index": 1, "scale": -0.5}})");
    const Material m = material();
    EXPECT_EQ(m.clearcoat, 0.5f);
    EXPECT_EQ(m.clearcoatRoughness, 0.75f);
    EXPECT_EQ(m.clearcoatNormalScale, -0.5f);
    EXPECT_TRUE(m.clearcoatTexture && !m.clearcoatTexture.srgb);
    EXPECT_TRUE(m.clearcoatRoughnessTexture && !m.clearcoatRoughnessTexture.srgb);
    EXPECT_TRUE(m.clearcoatNormalTexture && !m.clearcoatNormalTexture.srgb);
}

TEST_F(MaterialExtensionsTest, ReadsSheen) {
    extension("sheen", R"({"sheenColorFactor": [0.1, 0.2, 0.3], "sheenColorTexture": {"index": 0},
        "sheenRoughnessFactor": 0.4, "sheenRoughnessTexture": {"index": 0}})");
    const Material m = material();
    EXPECT_EQ(m.sheenColor, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.sheenRoughness, 0.4f);
    EXPECT_TRUE(m.sheenColorTexture && m.sheenColorTexture.srgb);
    EXPECT_TRUE(m.sheenRoughnessTexture && !m.sheenRoughnessTexture.srgb);
}

TEST_F(MaterialExtensionsTest, ReadsAnisotropy) {
    extension("anisotropy", R"({"anisotropyStrength": 0.6, "anisotropyRotation": -7.5,
        "anisotropyTexture": {"index": 0}})");
    const Material m = material();
    EXPECT_EQ(m.anisotropy, 0.6f);
    EXPECT_EQ(m.anisotropyRotation, -7.5f);
    EXPECT_TRUE(m.anisotropyTexture && !m.anisotropyTexture.srgb);
}

TEST_F(MaterialExtensionsTest, ReadsIridescence) {
    extension("iridescence", R"({"iridescenceFactor": 0.9, "iridescenceTexture": {"index": 0},
        "iridescenceIor": 1.8, "iridescenceThicknessMinimum": 500, "iridescenceThicknessMaximum": 200,
        "iridescenceThicknessTexture": {"index": 1}})");
    const Material m = material();
    EXPECT_EQ(m.iridescence, 0.9f);
    EXPECT_EQ(m.iridescenceIor, 1.8f);
    EXPECT_EQ(m.iridescenceThicknessMinimum, 500) << "the texture's 0, which may be the thicker end";
    EXPECT_EQ(m.iridescenceThicknessMaximum, 200);
    EXPECT_TRUE(m.iridescenceTexture && !m.iridescenceTexture.srgb);
    EXPECT_TRUE(m.iridescenceThicknessTexture && !m.iridescenceThicknessTexture.srgb);
}

TEST_F(MaterialExtensionsTest, ReadsDispersionAndDiffuseTransmission) {
    extension("dispersion", R"({"dispersion": 1.25})");
    extension("diffuse_transmission", R"({"diffuseTransmissionFactor": 0.3,
        "diffuseTransmissionTexture": {"index": 0}, "diffuseTransmissionColorFactor": [0.9, 0.8, 0.7],
        "diffuseTransmissionColorTexture": {"index": 0}})");
    const Material m = material();
    EXPECT_EQ(m.dispersion, 1.25f) << "above 1: an Abbe number below 20";
    EXPECT_EQ(m.diffuseTransmission, 0.3f);
    EXPECT_EQ(m.diffuseTransmissionColor, glm::vec3(0.9f, 0.8f, 0.7f));
    EXPECT_TRUE(m.diffuseTransmissionTexture && !m.diffuseTransmissionTexture.srgb);
    EXPECT_TRUE(m.diffuseTransmissionColorTexture && m.diffuseTransmissionColorTexture.srgb);
}

TEST_F(MaterialExtensionsTest, KeepsAnIndexOfRefractionOfZero) {
    extension("ior", R"({"ior": 0})");
    const Scene scene = load();
    EXPECT_EQ(scene.materials[0].ior, 0);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(MaterialExtensionsTest, ReadsNoTextureThatAFactorHides) {
    extension("clearcoat", R"({"clearcoatTexture": {"index": 0}, "clearcoatNormalTexture": {"index": 0}})");
    extension("sheen", R"({"sheenColorTexture": {"index": 0}})");
    extension("iridescence", R"({"iridescenceTexture": {"index": 0}})");
    extension("specular", R"({"specularFactor": 0, "specularColorTexture": {"index": 0}})");
    EXPECT_TRUE(load().images.empty());
}

TEST_F(MaterialExtensionsTest, ClampsFactorsOutOfRangeWithAWarning) {
    const std::pair<const char*, const char*> cases[] = {
        {"specular", "specularFactor"},
        {"clearcoat", "clearcoatFactor"},
        {"clearcoat", "clearcoatRoughnessFactor"},
        {"sheen", "sheenRoughnessFactor"},
        {"anisotropy", "anisotropyStrength"},
        {"iridescence", "iridescenceFactor"},
        {"diffuse_transmission", "diffuseTransmissionFactor"},
        {"transmission", "transmissionFactor"},
    };
    for (const auto& [name, member] : cases) {
        builder.set("/materials/0", R"({"name": "Odd"})");
        extension(name, std::string("{\"") + member + "\": 1.5}");
        const Scene scene = load();
        ASSERT_EQ(scene.warnings.size(), 1u) << member;
        EXPECT_EQ(scene.warnings[0].feature, member);
        EXPECT_EQ(scene.warnings[0].where, "materials/0 (Odd)");
        EXPECT_THAT(scene.warnings[0].instead, HasSubstr("rendered with 1"));
    }
    builder.set("/materials/0", "{}");
    extension("sheen", R"({"sheenColorFactor": [2, 0, -1]})");
    EXPECT_EQ(material().sheenColor, glm::vec3(1, 0, 0));
    extension("dispersion", R"({"dispersion": -1})");
    EXPECT_EQ(material().dispersion, 0);
    extension("iridescence", R"({"iridescenceIor": 0.5, "iridescenceThicknessMaximum": -3})");
    EXPECT_EQ(material().iridescenceIor, 1);
    EXPECT_EQ(material().iridescenceThicknessMaximum, 0);
}

TEST_F(MaterialExtensionsTest, RefusesWhatCannotBeUnderstood) {
    struct Case {
        const char *name, *json, *fault;
    };
    for (const Case& c : {
             Case{"specular", R"({"specularColorFactor": [1, 1]})",
                  "KHR_materials_specular/specularColorFactor: must have 3 numbers, has 2"},
             Case{"specular", R"({"specularTexture": {"index": 9}})",
                  "KHR_materials_specular/specularTexture/index: refers to /textures/9"},
             Case{"clearcoat", R"({"clearcoatFactor": "1"})",
                  "KHR_materials_clearcoat/clearcoatFactor: must"},
             Case{"clearcoat", R"({"clearcoatFactor": 1, "clearcoatNormalTexture": {}})",
                  "clearcoatNormalTexture/index: is missing"},
             Case{"sheen", R"({"sheenRoughnessFactor": []})", "sheenRoughnessFactor: must"},
             Case{"anisotropy", R"({"anisotropyRotation": null})", "anisotropyRotation: must"},
             Case{"iridescence", R"({"iridescenceIor": true})", "iridescenceIor: must"},
             Case{"dispersion", R"({"dispersion": {}})", "dispersion: must"},
             Case{"diffuse_transmission", R"({"diffuseTransmissionColorFactor": 1})",
                  "diffuseTransmissionColorFactor: must"},
             Case{"pbrSpecularGlossiness", R"({"diffuseFactor": [1, 1, 1]})",
                  "diffuseFactor: must have 4 numbers, has 3"},
         }) {
        builder.set("/materials/0", "{}");
        extension(c.name, c.json);
        EXPECT_THAT(fault(), HasSubstr(c.fault)) << c.json;
    }
}

TEST_F(MaterialExtensionsTest, WarnsOfAThicknessTextureWhereLightEnters) {
    extension("volume", R"({"thicknessFactor": 1, "thicknessTexture": {"index": 0}})");
    EXPECT_TRUE(load().warnings.empty()) << "opaque";
    extension("transmission", R"({"transmissionFactor": 1})");
    builder.set("/scenes/0/nodes", "[]");  // no open surface has it
    const Scene scene = load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "thicknessTexture");
}

TEST_F(MaterialExtensionsTest, ConvertsSpecularGlossinessFactors) {
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}})");
    extension("pbrSpecularGlossiness", R"({"diffuseFactor": [0.2, 0.4, 0.8, 0.5],
        "specularFactor": [0.1, 0.5, 0.25], "glossinessFactor": 0.75})");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.baseColor, glm::vec3(0.1f, 0.2f, 0.4f)) << "less what is reflected: 1 - 0.5";
    EXPECT_EQ(m.alpha, 0.5f);
    EXPECT_EQ(m.metallic, 0);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.ior, 0) << "F0 is the specular colour";
    EXPECT_EQ(m.specularColor, glm::vec3(0.1f, 0.5f, 0.25f));
    EXPECT_EQ(m.specular, 1);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(MaterialExtensionsTest, BakesTheSpecularGlossinessTexture) {
    extension("pbrSpecularGlossiness", R"({"specularFactor": [1, 0.5, 0.5], "glossinessFactor": 0.5,
        "specularGlossinessTexture": {"index": 0}})");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.roughness, 1);
    EXPECT_FALSE(m.metallicRoughnessTexture.srgb);
    const Image& roughness = scene.images.at(m.metallicRoughnessTexture.image);
    EXPECT_EQ(roughness.rgba8.at(1), 235) << "255 - 0.5 * 40";
    EXPECT_EQ(roughness.rgba8.at(5), 215);

    EXPECT_TRUE(m.specularColorTexture.srgb);
    EXPECT_THAT(scene.images.at(m.specularColorTexture.image).rgba8,
                ElementsAre(10, 20, 30, 40, 50, 60, 70, 80));
    EXPECT_EQ(m.specularColor, glm::vec3(1, 0.5f, 0.5f));

    // White less the largest of the linear specular colour: 60 and 70 count half, 50 whole.
    EXPECT_TRUE(m.baseColorTexture.srgb);
    const Image& diffuse = scene.images.at(m.baseColorTexture.image);
    const double linear = std::pow((50 / 255.0 + 0.055) / 1.055, 2.4);
    const double wanted = 255 * (1.055 * std::pow(1 - linear, 1 / 2.4) - 0.055);
    EXPECT_NEAR(diffuse.rgba8.at(4), wanted, 0.51);
    EXPECT_EQ(diffuse.rgba8.at(4), diffuse.rgba8.at(6)) << "darkened alike";
    EXPECT_EQ(diffuse.rgba8.at(7), 255) << "no alpha of a diffuse texture";
}

TEST_F(MaterialExtensionsTest, MultipliesDiffuseAndSpecularTexturesOfDifferentSizes) {
    extension("pbrSpecularGlossiness", R"({"diffuseTexture": {"index": 1},
        "specularGlossinessTexture": {"index": 0}})");
    const Scene scene = load();
    const Image& diffuse = scene.images.at(scene.materials[0].baseColorTexture.image);
    ASSERT_EQ(diffuse.width, 2u);
    const auto linear = [](double v) { return std::pow((v / 255 + 0.055) / 1.055, 2.4); };
    const double wanted = 255 * (1.055 * std::pow(linear(200) * (1 - linear(70)), 1 / 2.4) - 0.055);
    EXPECT_NEAR(diffuse.rgba8.at(4), wanted, 0.51);
    EXPECT_EQ(scene.images.at(scene.materials[0].metallicRoughnessTexture.image).rgba8.at(5), 255 - 80);
}

TEST_F(MaterialExtensionsTest, KeepsSixteenBitsOfASpecularGlossinessTexture) {
    addImage(encodePng(1, 1, 4, 16, {13107, 0, 0, 257}));
    extension("pbrSpecularGlossiness", R"({"specularGlossinessTexture": {"index": 2}})");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(scene.images.at(m.metallicRoughnessTexture.image).rgbaFloat.at(1), 1 - 257 / 65535.0f);
    EXPECT_FALSE(m.baseColorTexture.srgb);
    EXPECT_NEAR(scene.images.at(m.baseColorTexture.image).rgbaFloat.at(0), 1 - 0.033104767, 1e-6);
}

TEST_F(MaterialExtensionsTest, SharesWhatItBakes) {
    const char* json = R"({"specularGlossinessTexture": {"index": 0}, "diffuseTexture": {"index": 1}})";
    extension("pbrSpecularGlossiness", json);
    builder.set("/materials/1/extensions/KHR_materials_pbrSpecularGlossiness", json);
    builder.set("/meshes/0/primitives/1/attributes/POSITION", 0).set("/meshes/0/primitives/1/material", 1);
    const Scene scene = load();
    EXPECT_EQ(scene.images.size(), 3u) << "specular colour, roughness, darkened diffuse";
    EXPECT_EQ(scene.materials[0].baseColorTexture.image, scene.materials[1].baseColorTexture.image);
}

TEST_F(MaterialExtensionsTest, SaysWhereTexturesThatLieDifferentlyCannotBeMultiplied) {
    extension("pbrSpecularGlossiness", R"({"specularGlossinessTexture": {"index": 0},
        "diffuseTexture": {"index": 1, "texCoord": 1}})");
    const Scene scene = load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "KHR_materials_pbrSpecularGlossiness");
    EXPECT_THAT(scene.images.at(scene.materials[0].baseColorTexture.image).rgba8,
                ElementsAre(200, 100, 50, 255));
}

struct VariantsTest : MaterialExtensionsTest {
    VariantsTest() {
        builder.set("/materials/1/name", R"("Blue")").set("/materials/2/name", R"("Green")");
        builder.set("/extensions/KHR_materials_variants/variants",
                    R"([{"name": "noon"}, {"name": "dusk"}, {"name": "night"}])");
        builder.set("/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings",
                    R"([{"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}])");
    }
    std::string nameOfMaterial(const std::string& variant) {
        const Scene scene = load(variant);
        EXPECT_TRUE(scene.warnings.empty());
        return scene.materials.at(scene.meshes.at(0).material).name;
    }
};

TEST_F(VariantsTest, GivePrimitivesTheirMaterials) {
    EXPECT_EQ(nameOfMaterial(""), "");
    EXPECT_EQ(nameOfMaterial("noon"), "Blue");
    EXPECT_EQ(nameOfMaterial("dusk"), "Green");
    EXPECT_EQ(nameOfMaterial("night"), "") << "no mapping: the primitive's own";
}

TEST_F(VariantsTest, UnknownOnesAreRefusedWithTheNamesThereAre) {
    EXPECT_THAT(fault("dawn"), HasSubstr("no material variant 'dawn'; there are noon, dusk, night"));
    builder.erase("/extensions/KHR_materials_variants");
    builder.erase("/meshes/0/primitives/0/extensions");
    EXPECT_THAT(fault("dawn"), HasSubstr("has no material variants"));
}

TEST_F(VariantsTest, MappingsThatLeadNowhereAreRefused) {
    const std::string mapping = "/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/1/";
    builder.set(mapping + "material", 3);
    EXPECT_THAT(fault(), HasSubstr(mapping + "material: refers to /materials/3"));
    builder.set(mapping + "material", 1).set(mapping + "variants/0", 3);
    EXPECT_THAT(fault(), HasSubstr(mapping + "variants/0: refers to "));
}

}  // namespace
}  // namespace tilefarm
