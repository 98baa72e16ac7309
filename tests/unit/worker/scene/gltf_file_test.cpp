#include "worker/scene/gltf_file.h"

#include <gmock/gmock.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

struct GltfFileTest : testing::Test {
    TemporaryFolder folder;

    std::string faultOf(const std::filesystem::path& path) {
        const Error error = errorOf([&] { loadGltf(path); });
        EXPECT_EQ(error.code, ErrorCode::invalidArgument);
        EXPECT_THAT(error.what(), HasSubstr(path.filename().string()));
        return error.what();
    }
    std::string faultOf(GltfBuilder& builder) { return faultOf(builder.writeGltf(folder.path())); }
};

TEST_F(GltfFileTest, ReadsTheSameTriangleFromEveryContainer) {
    GltfBuilder builder = GltfBuilder::triangle();
    GltfBuilder embedded = GltfBuilder::triangle(), glb = GltfBuilder::triangle();
    for (const auto& path :
         {builder.writeGltf(folder.path(), "a.gltf"), embedded.writeEmbedded(folder.path(), "b.gltf"),
          glb.writeGlb(folder.path(), "c.glb")}) {
        const Scene scene = loadGltf(path);
        ASSERT_EQ(scene.meshes.size(), 1u) << path;
        EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(0, 1, 0)) << path;
        EXPECT_EQ(scene.meshes[0].triangles.size(), 1u) << path;
        EXPECT_TRUE(scene.warnings.empty()) << path;
    }
}

TEST_F(GltfFileTest, DecodesPercentEscapesAndSubfolders) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.writeGltf(folder.path());
    std::filesystem::create_directory(folder / "my data");
    std::filesystem::rename(folder / "scene.bin", folder / "my data/b\xC3\xA4.bin");
    builder.set("/buffers/0/uri", R"("my%20data/x/../b%C3%a4.bin")");
    EXPECT_EQ(loadGltf(builder.writeGltf(folder.path())).meshes.size(), 1u);
}

TEST_F(GltfFileTest, ReadsNothingOutsideOfTheScenesFolder) {
    writeText(folder / "secret.bin", std::string(64, 'x'));
    std::filesystem::create_directory(folder / "scene");
    for (const char* uri :
         {"../secret.bin", "%2e%2e/secret.bin", "a/../../secret.bin", "/etc/passwd", "file:///etc/passwd",
          "http://localhost/x.bin", "..\\\\secret.bin", "a%00.bin", ""}) {
        GltfBuilder builder = GltfBuilder::triangle();
        builder.set("/buffers/0/uri", std::string("\"") + uri + "\"");
        const Error error = errorOf([&] { loadGltf(builder.writeGltf(folder / "scene")); });
        ASSERT_EQ(error.faults.size(), 1u) << uri;
        EXPECT_EQ(error.faults[0].pointer, "/buffers/0/uri") << uri;
    }
}

TEST_F(GltfFileTest, NamesWhatIsWrongWithAFile) {
    EXPECT_THAT(faultOf(folder / "absent.gltf"), HasSubstr("no such file"));
    writeText(folder / "empty.gltf", "");
    EXPECT_THAT(faultOf(folder / "empty.gltf"), HasSubstr("not valid JSON"));
    writeText(folder / "array.gltf", "[1]");
    EXPECT_THAT(faultOf(folder / "array.gltf"), HasSubstr("not an object"));
    writeText(folder / "twice.gltf", R"({"asset": {"version": "2.0", "version": "1.0"}})");
    EXPECT_THAT(faultOf(folder / "twice.gltf"), HasSubstr("\"version\" stands twice"));
    writeText(folder / "deep.gltf", std::string(100000, '['));
    EXPECT_THAT(faultOf(folder / "deep.gltf"), HasSubstr("nested deeper"));
    writeText(folder / "old.gltf", R"({"asset": {"version": "1.0"}})");
    EXPECT_THAT(faultOf(folder / "old.gltf"), HasSubstr("/asset/version: is \"1.0\""));
    writeText(folder / "none.gltf", "{}");
    EXPECT_THAT(faultOf(folder / "none.gltf"), HasSubstr("/asset/version: is missing"));
    writeText(folder / "number.gltf",
              R"({"asset": {"version": "2.0"}, "nodes": [{"scale": [1, 1e999, 1]}]})");
    EXPECT_THAT(faultOf(folder / "number.gltf"), HasSubstr("not valid JSON"));
}

TEST_F(GltfFileTest, EveryTruncationOfAGlbIsAnErrorAndNoCrash) {
    GltfBuilder builder = GltfBuilder::square();
    const std::vector<std::byte> whole = readFileBytes(builder.writeGlb(folder.path()));
    for (size_t length = 0; length < whole.size(); length += length < 40 ? 1 : 13) {
        writeBytes(folder / "cut.glb", std::span(whole).first(length));
        EXPECT_EQ(codeOf([&] { loadGltf(folder / "cut.glb"); }), ErrorCode::invalidArgument) << length;
    }
}

TEST_F(GltfFileTest, ChecksRangesOfBuffersAndViews) {
    struct Case {
        const char *pointer, *json, *fault;
    };
    for (const Case& c :
         {Case{"/buffers/0/byteLength", "1000", "/buffers/0/byteLength: says 1000 bytes, but there are 36"},
          Case{"/buffers/0/byteLength", "-1", "/buffers/0/byteLength: must be an integer"},
          Case{"/buffers/0/byteLength", "35.5", "/buffers/0/byteLength: must be an integer"},
          Case{"/buffers/0/byteLength", "\"36\"", "/buffers/0/byteLength: must be an integer, is string"},
          Case{"/buffers/0/uri", "\"absent.bin\"", "/buffers/0/uri: "},
          Case{"/buffers/0/uri", "\"data:;base64,AB?=\"", "/buffers/0/uri: its base64 data"},
          Case{"/buffers/0/uri", "\"data:nothing\"", "/buffers/0/uri: is a data URI without data"},
          Case{"/bufferViews/0/buffer", "1", "/bufferViews/0/buffer: refers to /buffers/1"},
          Case{"/bufferViews/0/byteLength", "37", "/bufferViews/0: bytes 0 … 37 lie outside"},
          Case{"/bufferViews/0/byteOffset", "18446744073709551615", "/bufferViews/0/byteOffset: must be"},
          Case{"/bufferViews/0/byteStride", "8", "/accessors/0: its elements of 12 bytes overlap"},
          Case{"/bufferViews/0/byteStride", "1", "/bufferViews/0/byteStride: must be"},
          Case{"/bufferViews/0/byteStride", "256", "/bufferViews/0/byteStride: must be"},
          Case{"/bufferViews/0/byteStride", "16", "/accessors/0: its 3 elements end at byte 44"},
          Case{"/accessors/0/count", "4", "/accessors/0: its 4 elements end at byte 48"},
          Case{"/accessors/0/count", "4294967295", "/accessors/0/count: must be"},
          Case{"/accessors/0/byteOffset", "4", "/accessors/0: its 3 elements end at byte 40"},
          Case{"/accessors/0/bufferView", "7", "/accessors/0/bufferView: refers to /bufferViews/7"},
          Case{"/accessors/0/componentType", "5124", "/accessors/0/componentType: is 5124"},
          Case{"/accessors/0/type", "\"VEC5\"", "/accessors/0/type: is \"VEC5\""},
          Case{"/accessors/0/type", "\"VEC2\"", "/accessors/0/type: must be VEC3 here"}}) {
        GltfBuilder builder = GltfBuilder::triangle();
        builder.writeGltf(folder.path());
        builder.set(c.pointer, c.json);
        EXPECT_THAT(faultOf(builder), HasSubstr(c.fault));
    }
}

TEST_F(GltfFileTest, WantsAKnownRequiredExtensionAndWarnsOfAUsedOne) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/extensionsUsed", R"(["KHR_materials_unlit", "ACME_magic"])");
    const Scene scene = loadGltf(builder.writeGltf(folder.path()));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "ACME_magic");
    builder.set("/extensionsRequired", R"(["ACME_magic"])");
    EXPECT_THAT(faultOf(builder),
                HasSubstr("/extensionsRequired/0: the scene cannot be read without ACME_magic"));
}

}  // namespace
}  // namespace tilefarm
