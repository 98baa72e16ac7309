// Files that are not valid by the letter, or broken where nothing looks: rendered with a warning that names
// the place, unless strict.
#include <gmock/gmock.h>

#include <functional>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/gltf_source.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

const std::filesystem::path kCases = std::filesystem::path(TILEFARM_SHARED_DATA) / "cases";

struct Flaw {
    const char* name;
    std::function<void(GltfBuilder&)> add;
    const char* where;  // of the warning
};

void PrintTo(const Flaw& flaw, std::ostream* out) {
    *out << flaw.name;
}

/// A file that says the place of what it holds, once as it is and once as strict.
struct ToleranceTest : testing::TestWithParam<Flaw> {
    TemporaryFolder folder;

    static Scene load(const std::filesystem::path& path, GltfOptions options = {}) {
        return GltfSource(path, std::move(options)).take();
    }
    static std::vector<std::string> placesOf(const Scene& scene) {
        std::vector<std::string> places;
        for (const SceneWarning& warning : scene.warnings) places.push_back(warning.where);
        return places;
    }
};

TEST_P(ToleranceTest, WarnsOfThePlaceAndStrictRefusesIt) {
    GltfBuilder builder = GltfBuilder::square();
    GetParam().add(builder);
    const auto path = builder.writeGltf(folder.path());
    const Scene scene = load(path, {.animation = "none"});
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_THAT(placesOf(scene), testing::Contains(GetParam().where));
    const Error error = errorOf([&] { load(path, {.animation = "none", .strict = true}); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_THAT(error.what(), HasSubstr(std::string("/") + GetParam().where));
}

INSTANTIATE_TEST_SUITE_P(Invalid, ToleranceTest,
                         testing::Values(Flaw{"StrideOfZero",
                                              [](GltfBuilder& b) { b.set("/bufferViews/0/byteStride", 0u); },
                                              "bufferViews/0/byteStride"},
                                         Flaw{"RangeOfZero",
                                              [](GltfBuilder& b) {
                                                  b.set("/extensions/KHR_lights_punctual/lights/0",
                                                        R"({"type": "point", "range": 0})");
                                              },
                                              "extensions/KHR_lights_punctual/lights/0/range"},
                                         Flaw{"ConesThatDifferByRounding",
                                              [](GltfBuilder& b) {
                                                  b.set("/extensions/KHR_lights_punctual/lights/0",
                                                        R"({"type": "spot",
                     "spot": {"innerConeAngle": 0.7853982, "outerConeAngle": 0.78539816}})");
                                              },
                                              "extensions/KHR_lights_punctual/lights/0/spot"}),
                         [](const auto& flaw) { return flaw.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Unused, ToleranceTest,
    testing::Values(
        Flaw{"Accessor",
             [](GltfBuilder& b) {
                 b.set("/accessors/" + std::to_string(b.size("/accessors")),
                       R"({"bufferView": 0, "type": "VEC9", "componentType": 5126, "count": 1})");
             },
             "accessors/4"},
        Flaw{"View",
             [](GltfBuilder& b) {
                 b.set("/bufferViews/" + std::to_string(b.size("/bufferViews")),
                       R"({"buffer": 0, "byteLength": 100000})");
             },
             "bufferViews/4"},
        Flaw{"Image", [](GltfBuilder& b) { b.set("/images/0/uri", R"("never-used.png")"); }, "images/0"},
        Flaw{"ImageElsewhere", [](GltfBuilder& b) { b.set("/images/0/uri", R"("http://localhost/a.png")"); },
             "images/0"},
        Flaw{"ImageWhoseFallbackIsThere",
             [](GltfBuilder& b) {
                 b.set("/images/0/uri",
                       "\"data:image/png;base64," + base64(encodePng(1, 1, 3, 8, {9, 8, 7})) + "\"");
                 b.set("/images/1/uri", R"("gone.webp")");
                 b.set("/textures/0", R"({"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}})");
                 b.set("/materials/0/pbrMetallicRoughness/baseColorTexture/index", 0u);
             },
             "images/1"},
        Flaw{"ImageThatAFactorHides",
             [](GltfBuilder& b) {
                 b.set("/images/0/uri", R"("gone.png")").set("/textures/0/source", 0u);
                 b.set("/materials/0/extensions/KHR_materials_clearcoat",
                       R"({"clearcoatTexture": {"index": 0}})");
             },
             "images/0"},
        Flaw{"Buffer", [](GltfBuilder& b) { b.set("/buffers/1", R"({"byteLength": 4, "uri": "gone.bin"})"); },
             "buffers/1"},
        Flaw{"Material", [](GltfBuilder& b) { b.set("/materials/1/normalTexture/index", 7u); },
             "materials/1"},
        Flaw{"Mesh", [](GltfBuilder& b) { b.set("/meshes/1/primitives/0/attributes/POSITION", 99u); },
             "meshes/1"},
        Flaw{"Skin", [](GltfBuilder& b) { b.set("/skins/0/joints", "[42]"); }, "skins/0"},
        Flaw{"Camera", [](GltfBuilder& b) { b.set("/cameras/0", R"({"type": "fisheye"})"); }, "cameras/0"},
        Flaw{"Light",
             [](GltfBuilder& b) { b.set("/extensions/KHR_lights_punctual/lights/0", R"({"type": "neon"})"); },
             "extensions/KHR_lights_punctual/lights/0"},
        Flaw{"Shape",
             [](GltfBuilder& b) { b.set("/extensions/KHR_implicit_shapes/shapes/0", R"({"type": "knot"})"); },
             "extensions/KHR_implicit_shapes/shapes/0"},
        Flaw{"NodeOutsideOfTheScene", [](GltfBuilder& b) { b.set("/nodes/1/rotation", "[0, 0, 0, 0]"); },
             "nodes/1"},
        Flaw{"Animation",
             [](GltfBuilder& b) {
                 b.set("/animations/0", R"({"samplers": [{"input": 77, "output": 0}],
                     "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]})");
             },
             "animations/0"},
        Flaw{"VertexAttribute", [](GltfBuilder& b) { b.set("/meshes/0/primitives/0/attributes/_WIND", 99u); },
             "meshes/0/primitives/0/attributes/_WIND"}),
    [](const auto& flaw) { return flaw.param.name; });

TEST_F(ToleranceTest, WhatIsNeededStaysAFault) {
    for (const auto& [pointer, json] : std::vector<std::pair<std::string, std::string>>{
             {"/nodes/0/skin", "0"}, {"/nodes/0/camera", "0"}, {"/meshes/0/primitives/0/material", "1"}}) {
        GltfBuilder builder = GltfBuilder::square();
        builder.set("/skins/0/joints", "[42]").set("/cameras/0", R"({"type": "fisheye"})");
        builder.set("/materials/1/emissiveFactor", "[1, 1, \"one\"]");
        builder.set("/meshes/0/primitives/0/attributes/JOINTS_0",
                    builder.accessor(std::vector<uint8_t>(16), "VEC4"));
        builder.set("/meshes/0/primitives/0/attributes/WEIGHTS_0",
                    builder.accessor(std::vector<glm::vec4>(4, {1, 0, 0, 0})));
        builder.writeGltf(folder.path());
        EXPECT_NO_THROW(load(folder / "scene.gltf"));
        builder.set(pointer, json);
        EXPECT_EQ(codeOf([&] { load(builder.writeGltf(folder.path())); }), ErrorCode::invalidArgument)
            << pointer;
    }
}

TEST_F(ToleranceTest, AFileThatShowsNothingIsForgivenNothing) {
    for (const char* scenes : {R"([])", R"([{"nodes": []}])"}) {
        GltfBuilder builder = GltfBuilder::square();
        builder.set("/nodes", "[]").set("/scenes", scenes).erase("/scene");
        EXPECT_NO_THROW(load(builder.writeGltf(folder.path())));
        builder.set("/meshes/0/primitives/0/indices", 99u);
        EXPECT_THAT(errorOf([&] { load(builder.writeGltf(folder.path())); }).what(),
                    HasSubstr("/meshes/0/primitives/0/indices: refers to /accessors/99"));
    }
}

TEST_F(ToleranceTest, TakesDataUrisWithLineBreaksAndCapitals) {
    GltfBuilder builder = GltfBuilder::triangle();
    const auto plain = builder.writeEmbedded(folder.path());
    const std::vector<std::byte> bytes = readFileBytes(plain);
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const size_t at = text.find(";base64,") + 8;
    text.insert(at + 8, "\\r\\n ");
    text.replace(text.find("data:"), 5, "DATA:");
    writeText(folder / "wrapped.gltf", text);
    const Scene scene = load(folder / "wrapped.gltf");
    EXPECT_EQ(scene.meshes.at(0).positions, load(plain).meshes.at(0).positions);
    EXPECT_THAT(placesOf(scene), testing::Contains("buffers/0/uri"));
    EXPECT_THAT(errorOf([&] { load(folder / "wrapped.gltf", {.strict = true}); }).what(),
                HasSubstr("/buffers/0/uri"));
}

TEST_F(ToleranceTest, KeysMayStandTwiceInExtrasAlone) {
    const auto withObject = [&](const std::string& marker) {
        GltfBuilder builder = GltfBuilder::triangle();
        builder.set(marker, R"({"k": "MARK"})");
        const std::vector<std::byte> bytes = readFileBytes(builder.writeGltf(folder.path()));
        std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        const size_t at = text.find("\"MARK\"");
        writeText(folder / "twice.gltf", text.insert(at, "1, \"k\": "));
        return folder / "twice.gltf";
    };
    const Scene scene = load(withObject("/nodes/0/extras/list/1"));
    EXPECT_THAT(placesOf(scene), testing::ElementsAre("nodes/0/extras/list/1/k"));
    EXPECT_THAT(errorOf([&] { load(folder / "twice.gltf", {.strict = true}); }).what(),
                HasSubstr("\"k\" stands twice"));
    EXPECT_THAT(errorOf([&] { load(withObject("/nodes/0/other")); }).what(), HasSubstr("\"k\" stands twice"));
}

TEST_F(ToleranceTest, BytesBehindAGlbAreNoChunks) {
    GltfBuilder builder = GltfBuilder::square();
    std::vector<std::byte> glb = readFileBytes(builder.writeGlb(folder.path()));
    glb.insert(glb.end(), 13, std::byte{0xff});
    writeBytes(folder / "longer.glb", glb);
    EXPECT_EQ(load(folder / "longer.glb").instances.size(), 1u);
    EXPECT_THAT(errorOf([&] { load(folder / "longer.glb", {.strict = true}); }).what(),
                HasSubstr("its header says"));
}

TEST_F(ToleranceTest, ReadsAboveItsFolderOnlyAsFarAsItsBundleReaches) {
    std::filesystem::create_directories(folder / "project/models");
    std::filesystem::create_directories(folder / "project/data");
    GltfBuilder builder = GltfBuilder::triangle();
    builder.writeGltf(folder / "project/models");
    std::filesystem::rename(folder / "project/models/scene.bin", folder / "project/data/scene.bin");
    builder.set("/buffers/0/uri", R"("../data/scene.bin")");
    const auto path = builder.writeGltf(folder / "project/models");
    EXPECT_EQ(load(path, {.levelsUp = 1}).meshes.size(), 1u);
    EXPECT_THAT(errorOf([&] { load(path); }).what(), HasSubstr("/buffers/0/uri"));
}

TEST_F(ToleranceTest, TheLaterOfTwoKeysAtOneTimeHolds) {
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/animations/0/channels/0",
                R"({"sampler": 0, "target": {"node": 0, "path": "translation"}})");
    builder.set("/animations/0/samplers/0/input", builder.accessor(std::vector<float>{0, 1, 1, 2}, "SCALAR"));
    builder.set("/animations/0/samplers/0/output",
                builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {6, 0, 0}}));
    const auto path = builder.writeGltf(folder.path());
    GltfSource source(path, {});
    EXPECT_EQ(source.at(0.5).instances.at(0).toWorld[3].x, 0.5);
    EXPECT_EQ(source.at(1.5).instances.at(0).toWorld[3].x, 5.5);
    EXPECT_THAT(placesOf(source.at(1)), testing::Contains("animations/0/samplers/0/input"));
    EXPECT_THAT(errorOf([&] { GltfSource(path, {.strict = true}); }).what(),
                HasSubstr("times must be finite and grow"));
}

TEST_F(ToleranceTest, SharedCasesLoad) {
    if (!std::filesystem::exists(kCases)) GTEST_SKIP() << "no shared data";
    EXPECT_EQ(load(kCases / "glb-trailing-bytes/s.glb").instances.size(), 1u);
    EXPECT_EQ(load(kCases / "uri-missing-unused/s.gltf").instances.size(), 1u);
    EXPECT_EQ(load(kCases / "uri-parent/models/s.gltf", {.levelsUp = 1}).images.size(), 1u);
    const Scene still = load(kCases / "anim-bad-but-not-played/a.gltf", {.animation = "none"});
    EXPECT_EQ(still.meshes.at(0).positions,
              load(kCases / "anim-bad-but-not-played/b.gltf").meshes.at(0).positions);
    const Scene played = load(kCases / "anim-bad-but-not-played/a.gltf");
    EXPECT_THAT(placesOf(played), testing::Contains("animations/0/samplers/0/input")) << "two keys at 1 s";
}

}  // namespace
}  // namespace tilefarm
