#include "server/cli/scene_bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "shared/digest/digest.h"
#include "shared/file/durable_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Key;
using testing::UnorderedElementsAre;
namespace fs = std::filesystem;

struct SceneBundleTest : testing::Test {
    TemporaryFolder folder;

    fs::path put(const std::string& name, const std::string& bytes) {
        fs::create_directories((folder / name).parent_path());
        writeDurably(folder / name, bytes);
        return folder / name;
    }
    std::string faultOf(const std::string& gltf) {
        const fs::path file = put("bad.gltf", gltf);
        const Error error = errorOf([&] { bundleScene(file); });
        EXPECT_EQ(error.code, ErrorCode::invalidArgument);
        EXPECT_THAT(error.what(), HasSubstr("bad.gltf"));
        return error.what();
    }
    std::string faultOfUri(const std::string& uri) {
        return faultOf(R"({"images": [{}, {"uri": ")" + uri + "\"}]}");
    }
};

std::string glbOf(std::string json, const std::string& rest = {}) {
    while (json.size() % 4) json += ' ';
    std::string glb(20, '\0');
    const uint32_t words[]{0x46546C67, 2, static_cast<uint32_t>(20 + json.size() + rest.size()),
                           static_cast<uint32_t>(json.size()), 0x4E4F534A};
    std::memcpy(glb.data(), words, sizeof words);
    return glb + json + rest;
}

TEST_F(SceneBundleTest, HoldsAllFilesTheGltfRefersTo) {
    const fs::path gltf = put("scene.gltf", R"({"asset": {"version": "2.0"},
        "buffers": [{"uri": "scene.bin"}, {"uri": "data:application/octet-stream;base64,AAAA"}],
        "images": [{"uri": "tex/wood%20%28dark%29.png"}, {"bufferView": 0, "mimeType": "image/png"},
                   {"uri": "./tex/./caf%C3%A9.jpg"}, {"uri": "scene.bin"}]})");
    put("scene.bin", "buffer");
    put("tex/wood (dark).png", "wood");
    put("tex/café.jpg", "café");
    put("unused.png", "unused");

    const BundledScene scene = bundleScene(gltf);
    EXPECT_EQ(scene.bundle.entry, "scene.gltf");
    EXPECT_EQ(scene.bundle.environment, "");
    EXPECT_THAT(scene.bundle.files, UnorderedElementsAre(Key("scene.gltf"), Key("scene.bin"),
                                                         Key("tex/wood (dark).png"), Key("tex/café.jpg")));
    for (const auto& [path, digest] : scene.bundle.files)
        EXPECT_EQ(sha256OfFile(scene.blobs.at(digest)), digest) << path;
}

TEST_F(SceneBundleTest, TellsThePlaceOfEachReference) {
    const fs::path gltf =
        put("s.gltf", R"({"buffers": [{"uri": "a.bin"}], "images": [{}, {"uri": "b.png"}]})");
    const auto references = gltfReferences(gltf);
    ASSERT_EQ(references.size(), 2u);
    EXPECT_EQ(references[0].place, "/buffers/0/uri");
    EXPECT_EQ(references[1].place, "/images/1/uri");
    EXPECT_EQ(references[1].path, "b.png");
}

TEST_F(SceneBundleTest, LooksIntoAGlb) {
    const fs::path glb =
        put("s.glb",
            glbOf(R"({"images": [{"uri": "beside.png"}], "buffers": [{"byteLength": 4}]})", "binary chunk"));
    put("beside.png", "png");
    EXPECT_THAT(bundleScene(glb).bundle.files, UnorderedElementsAre(Key("s.glb"), Key("beside.png")));
}

TEST_F(SceneBundleTest, RefusesBrokenGlbs) {
    const std::string good = glbOf(R"({"asset": {}})");
    const auto faultOfGlb = [&](std::string bytes) {
        const fs::path file = put("bad.glb", bytes);
        return std::string(errorOf([&] { bundleScene(file); }).what());
    };
    for (size_t size = 4; size < good.size(); ++size) faultOfGlb(good.substr(0, size));
    std::string version = good, kind = good, huge = good;
    version[4] = 1;
    EXPECT_THAT(faultOfGlb(version), HasSubstr("version 1"));
    kind[16] = 'X';
    EXPECT_THAT(faultOfGlb(kind), HasSubstr("does not begin with a chunk of JSON"));
    huge[15] = '\x7f';
    EXPECT_THAT(faultOfGlb(huge), HasSubstr("ends within its chunk"));
}

TEST_F(SceneBundleTest, NamesAMissingFileAndWhoAsksForIt) {
    EXPECT_THAT(faultOfUri("tex/gone.png"), AllOf(HasSubstr("/images/1/uri"), HasSubstr("tex/gone.png")));
    fs::create_directories(folder / "dir");
    EXPECT_THAT(faultOfUri("dir"), HasSubstr("/images/1/uri"));
}

TEST_F(SceneBundleTest, RefusesUrisThatLeaveTheFolder) {
    for (const char* uri :
         {"../a.png", "tex/../../a.png", "%2e%2e/a.png", "/etc/passwd", "..%2Fa.png", "a%5Cb.png", ""})
        EXPECT_THAT(faultOfUri(uri), HasSubstr("/images/1/uri")) << uri;
    for (const char* uri : {"http://h/a.png", "file:///a.png", "C:/a.png", "blob:x"})
        EXPECT_THAT(faultOfUri(uri), AllOf(HasSubstr("/images/1/uri"), HasSubstr("scheme"))) << uri;
    for (const char* uri : {"a%2", "a%", "a%zz.png"})
        EXPECT_THAT(faultOfUri(uri), HasSubstr("percent-encoded")) << uri;
    EXPECT_THAT(faultOfUri("a%00.png"), HasSubstr("control character"));
}

TEST_F(SceneBundleTest, RefusesWhatIsNoGltf) {
    EXPECT_THAT(faultOf("{\n  \"asset\": }"), HasSubstr("line 2, column 12"));
    EXPECT_THAT(faultOf("[]"), HasSubstr("no object"));
    EXPECT_THAT(faultOf(R"({"images": {}})"), HasSubstr("/images"));
    EXPECT_THAT(faultOf(R"({"buffers": [7]})"), HasSubstr("/buffers/0"));
    EXPECT_THAT(faultOf(R"({"buffers": [{"uri": 7}]})"), HasSubstr("/buffers/0/uri"));
    EXPECT_THAT(faultOf(""), HasSubstr("line 1, column 1"));
    EXPECT_EQ(codeOf([&] { bundleScene(folder / "absent.gltf"); }), ErrorCode::invalidArgument);
}

TEST_F(SceneBundleTest, TakesAnEnvironmentFromAnywhere) {
    const TemporaryFolder elsewhere;
    writeDurably(elsewhere / "sky.hdr", "sky");
    const fs::path gltf = put("s.gltf", R"({"images": [{"uri": "environment/sky.hdr"}]})");
    put("environment/sky.hdr", "the scene's own");
    const BundledScene scene = bundleScene(gltf, elsewhere / "sky.hdr");
    EXPECT_EQ(scene.bundle.environment, "environment/environment/sky.hdr");
    EXPECT_EQ(scene.bundle.files.at(scene.bundle.environment), sha256Hex(std::string_view("sky")));
    EXPECT_EQ(scene.bundle.files.size(), 3u);
    EXPECT_THAT(errorOf([&] { bundleScene(gltf, elsewhere / "dusk.hdr"); }).what(), HasSubstr("dusk.hdr"));
}

}  // namespace
}  // namespace tilefarm
