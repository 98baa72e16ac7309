// What a scene holds and is not rendered gives exactly one warning each.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

struct Held {
    const char* name;
    std::function<void(GltfBuilder&)> add;
    const char *feature, *where;
};

// gtest prints parameters; a name says more than bytes.
void PrintTo(const Held& held, std::ostream* out) {
    *out << held.name;
}

struct WarningsTest : testing::TestWithParam<Held> {
    TemporaryFolder folder;
};

TEST_P(WarningsTest, NameWhatIsHeldOnce) {
    GltfBuilder builder = GltfBuilder::square();
    const auto png = encodePng(1, 1, 4, 8, {1, 2, 3, 4});
    builder.set("/images/0/bufferView", builder.view(png)).set("/images/0/mimeType", R"("image/png")");
    builder.set("/textures/0/source", 0);
    builder.set("/materials/0", R"({"name": "M"})");
    GetParam().add(builder);
    const Scene scene = loadGltf(builder.writeGltf(folder.path()));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, GetParam().feature);
    EXPECT_EQ(scene.warnings[0].where, GetParam().where);
    EXPECT_FALSE(scene.warnings[0].instead.empty());
}

const char* const kPrimitive = "/meshes/0/primitives/0";

INSTANTIATE_TEST_SUITE_P(
    All, WarningsTest,
    testing::Values(
        Held{"SkinWithoutWeights",
             [](GltfBuilder& b) { b.set("/skins/0/joints", "[0]").set("/nodes/0/skin", 0); }, "skins",
             "nodes/0"},
        Held{"Scenes",
             [](GltfBuilder& b) { b.set("/scenes/1/nodes", "[]").set("/scenes/0/name", "\"First\""); },
             "scenes", "scenes"},
        Held{"UnknownExtension", [](GltfBuilder& b) { b.set("/extensionsUsed", R"(["EXT_time_travel"])"); },
             "EXT_time_travel", "extensionsUsed/0"},
        Held{"UnknownExtensionThatIsUsed",
             [](GltfBuilder& b) {
                 b.set("/extensionsUsed", R"(["EXT_time_travel"])");
                 b.set("/nodes/0/extensions/EXT_time_travel", "{}");
                 b.set("/materials/0/extensions/EXT_time_travel", "{}");
             },
             "EXT_time_travel", "extensionsUsed/0"},
        Held{"UndeclaredExtension",
             [](GltfBuilder& b) { b.set("/materials/0/extensions/EXT_time_travel", "{}"); },
             "EXT_time_travel", "materials/0 (M)"},
        Held{"TextureFormat",
             [](GltfBuilder& b) {
                 b.set("/extensionsUsed", R"(["KHR_texture_basisu"])");
                 b.set("/textures/0", R"({"extensions": {"KHR_texture_basisu": {"source": 0}}})");
                 b.set("/materials/0/normalTexture/index", 0);
                 b.set("/materials/0/emissiveTexture/index", 0);
             },
             "KHR_texture_basisu", "textures/0"},
        Held{"ThicknessTexture",
             [](GltfBuilder& b) {
                 b.set("/materials/0/extensions", R"({"KHR_materials_transmission": {"transmissionFactor": 1},
                     "KHR_materials_volume": {"thicknessFactor": 1, "thicknessTexture": {"index": 0}}})");
                 b.set("/scenes/0/nodes", "[]");  // no open surface has it
             },
             "thicknessTexture", "materials/0 (M)"},
        Held{"OpenVolume",
             [](GltfBuilder& b) {
                 b.set("/materials/0/extensions", R"({"KHR_materials_transmission": {"transmissionFactor": 1},
                     "KHR_materials_volume": {"thicknessFactor": 1}})");
             },
             "KHR_materials_volume", kPrimitive + 1},
        Held{"VolumeScatter",
             [](GltfBuilder& b) {
                 b.set("/extensionsUsed", R"(["KHR_materials_volume_scatter"])");
                 b.set("/materials/0/extensions/KHR_materials_volume_scatter", "{}");
             },
             "KHR_materials_volume_scatter", "materials/0 (M)"},
        Held{"Occlusion", [](GltfBuilder& b) { b.set("/materials/0/occlusionTexture/index", 0); },
             "occlusionTexture", "materials/0 (M)"},
        Held{"ThirdTextureCoordinates",
             [](GltfBuilder& b) { b.set("/materials/0/normalTexture", R"({"index": 0, "texCoord": 2})"); },
             "TEXCOORD_2", "materials/0/normalTexture"},
        Held{"Lines",
             [](GltfBuilder& b) {
                 b.set("/meshes/0/primitives/1", R"({"attributes": {"POSITION": 0}, "mode": 1})");
             },
             "lines", "meshes/0/primitives/1"}),
    [](const auto& held) { return held.param.name; });

TEST(Warnings, ATextureFormatThatIsRequiredIsAFault) {
    const TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/extensionsRequired", R"(["KHR_texture_basisu"])");
    EXPECT_THAT(errorOf([&] { loadGltf(builder.writeGltf(folder.path())); }).what(),
                HasSubstr("/extensionsRequired/0"));
}

TEST(Warnings, WhatIsRenderedGivesNone) {
    const TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/materials/0", R"({"occlusionTexture": {"index": 0, "strength": 0}})");
    builder.set("/extensionsUsed", R"(["KHR_materials_sheen", "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_variants", "KHR_materials_anisotropy", "KHR_texture_transform", "TILEFARM_lights"])");
    EXPECT_TRUE(loadGltf(builder.writeGltf(folder.path())).warnings.empty());
}

TEST(Warnings, WhatChangesNoPictureMayBeRequired) {
    const TemporaryFolder folder;
    for (const char* name : {"KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability",
                             "EXT_mesh_features", "EXT_structural_metadata"}) {
        GltfBuilder builder = GltfBuilder::square();
        builder.set("/extensionsUsed/0", fmt::format("\"{}\"", name));
        builder.set("/extensionsRequired/0", fmt::format("\"{}\"", name));
        builder.set(fmt::format("/nodes/0/extensions/{}", name), R"({"selectable": false})");
        EXPECT_TRUE(loadGltf(builder.writeGltf(folder.path())).warnings.empty()) << name;
    }
}

}  // namespace
}  // namespace tilefarm
