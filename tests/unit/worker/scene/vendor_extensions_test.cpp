#include <gmock/gmock.h>

#include <numbers>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

struct VendorExtensionsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();
    Scene load() { return loadGltf(builder.writeGltf(folder.path())); }
    Error error() {
        return errorOf([&] { load(); });
    }
    // A light on a node of its own, two metres up, turned so that it shines down, twice as large as life.
    void light(const std::string& json) {
        builder.set("/extensions/KHR_lights_punctual/lights/0", json);
        builder.set("/nodes/1", R"({"name": "Lamp", "translation": [0, 2, 0], "scale": [2, 2, 2],
            "rotation": [-0.7071067811865476, 0, 0, 0.7071067811865476],
            "extensions": {"KHR_lights_punctual": {"light": 0}}})");
        builder.set("/scenes/0/nodes/1", 1);
    }
};

TEST_F(VendorExtensionsTest, MaterialsSayWhatGltfCannot) {
    builder.set("/extensionsUsed", R"(["TILEFARM_materials", "TILEFARM_lights"])");
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"roughnessFactor": 0.5, "metallicFactor": 0},
        "extensions": {"TILEFARM_materials": {"subsurface": 0.25, "sheen": 0.5, "roughness": 0.75,
                                              "conductor": "copper", "fresnel": "schlick"}}})");
    const Scene scene = load();
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.subsurface, 0.25f);
    EXPECT_EQ(m.disneySheen, 0.5f);
    EXPECT_EQ(m.roughness, 0.75f) << "lies over the file's own";
    EXPECT_TRUE(m.conductor);
    EXPECT_EQ(m.fresnel, Fresnel::schlick);
    EXPECT_EQ(m.metallic, 0);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(VendorExtensionsTest, FaultsOfMaterialsAreAllNamed) {
    builder.set("/materials/0/extensions/TILEFARM_materials",
                R"({"subsurface": 2, "material": "x", "conductor": "tin", "clearcoatGloss": 1})");
    const Error fault = error();
    EXPECT_THAT(fault.what(), HasSubstr("scene.gltf"));
    std::vector<std::string> pointers;
    for (const Fault& f : fault.faults) pointers.push_back(f.pointer);
    const std::string place = "/materials/0/extensions/TILEFARM_materials";
    EXPECT_THAT(pointers,
                testing::ElementsAre(place + "/subsurface", place + "/conductor", place + "/material"));
}

TEST_F(VendorExtensionsTest, ARadiusMakesASphereOfTheSameFarField) {
    light(R"({"type": "point", "intensity": 10, "color": [1, 0.5, 0],
              "extensions": {"TILEFARM_lights": {"radius": 0.5}}})");
    const Scene scene = load();
    EXPECT_TRUE(scene.lights.empty());
    ASSERT_EQ(scene.areaLights.size(), 1u);
    const AreaLight& sphere = scene.areaLights[0];
    EXPECT_EQ(sphere.shape, AreaShape::sphere);
    EXPECT_EQ(sphere.radius, 0.5) << "whatever the scale of its node";
    EXPECT_EQ(sphere.position, glm::dvec3(0, 2, 0));
    EXPECT_EQ(sphere.name, "Lamp");
    EXPECT_NEAR(sphere.radiance.r * std::numbers::pi * 0.25, 10, 1e-5) << "W/sr";
    EXPECT_NEAR(sphere.radiance.g * std::numbers::pi * 0.25, 5, 1e-5);
}

TEST_F(VendorExtensionsTest, WidthAndHeightMakeARectangleThatShinesAlongTheNode) {
    light(R"({"type": "point", "intensity": 6, "name": "Panel",
              "extensions": {"TILEFARM_lights": {"width": 3, "height": 0.5, "twoSided": true}}})");
    const Scene scene = load();
    ASSERT_EQ(scene.areaLights.size(), 1u);
    const AreaLight& quad = scene.areaLights[0];
    EXPECT_EQ(quad.shape, AreaShape::quad);
    EXPECT_NEAR(glm::length(quad.u), 1.5, 1e-12);
    EXPECT_NEAR(glm::length(quad.v), 0.25, 1e-12);
    EXPECT_NEAR(glm::normalize(glm::cross(quad.u, quad.v)).y, -1, 1e-12);
    EXPECT_NEAR(quad.radiance.r * 3 * 0.5, 6, 1e-5) << "W/sr on the axis";
    EXPECT_TRUE(quad.twoSided);
    EXPECT_EQ(quad.name, "Panel");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(VendorExtensionsTest, ADirectionalLightGetsItsAngularSize) {
    light(R"({"type": "directional", "extensions": {"TILEFARM_lights": {"angularDiameter": 0.53}}})");
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_FLOAT_EQ(scene.lights[0].angularRadius, static_cast<float>(0.265 / 180 * std::numbers::pi));
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1)) << "still W/m²";
}

TEST_F(VendorExtensionsTest, SaysWhatAnAreaLightHasNoUseFor) {
    light(
        R"({"type": "spot", "range": 5, "spot": {}, "extensions": {"TILEFARM_lights": {"width": 1, "height": 1}}})");
    const Scene scene = load();
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.warnings[0].feature, "range");
    EXPECT_EQ(scene.warnings[1].feature, "spot");
}

TEST_F(VendorExtensionsTest, RefusesLightsThatCannotBe) {
    const std::string place = "/extensions/KHR_lights_punctual/lights/0/extensions/TILEFARM_lights";
    for (const auto& [json, pointer] : {
             std::pair(R"({"type": "point", "extensions": {"TILEFARM_lights": {"radius": 0}}})", "/radius"),
             std::pair(R"({"type": "spot", "spot": {}, "extensions": {"TILEFARM_lights": {"radius": 1}}})",
                       "/radius"),
             std::pair(R"({"type": "point", "extensions": {"TILEFARM_lights": {"width": 1}}})", ""),
             std::pair(R"({"type": "point", "extensions": {"TILEFARM_lights": {"angularDiameter": 1}}})",
                       "/angularDiameter"),
             std::pair(
                 R"({"type": "directional", "extensions": {"TILEFARM_lights": {"width": 1, "height": 1}}})",
                 ""),
             std::pair(R"({"type": "point", "extensions": {"TILEFARM_lights": {"twoSided": true}}})",
                       "/twoSided"),
             std::pair(R"({"type": "point", "extensions": {"TILEFARM_lights": {"size": 1}}})", "/size"),
         }) {
        light(json);
        const Error fault = error();
        ASSERT_EQ(fault.faults.size(), 1u) << json;
        EXPECT_EQ(fault.faults[0].pointer, place + pointer);
    }
}

}  // namespace
}  // namespace tilefarm
