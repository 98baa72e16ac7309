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
        return faultOf(R"({"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"material": 0}]}],
            "materials": [{"normalTexture": {"index": 0}}], "textures": [{"source": 1}],
            "images": [{}, {"uri": ")" +
                       uri + "\"}]}");
    }
};

std::string glbOf(std::string document, const std::string& rest = {}) {
    while (document.size() % 4) document += ' ';
    std::string glb(20, '\0');
    const uint32_t words[]{0x46546C67, 2, static_cast<uint32_t>(20 + document.size() + rest.size()),
                           static_cast<uint32_t>(document.size()), 0x4E4F534A};
    std::memcpy(glb.data(), words, sizeof words);
    return glb + document + rest;
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
    EXPECT_EQ(references[1].path.text(), "b.png");
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

TEST_F(SceneBundleTest, NamesEveryFileOnceHoweverItIsWritten) {
    const fs::path gltf = put("s.gltf", R"({"images": [{"uri": "sub/../tex.png"}, {"uri": "sub//tex.png"},
        {"uri": "./tex.png"}, {"uri": "DATA:image/png;base64,AAAA"}]})");
    put("tex.png", "a");
    put("sub/tex.png", "b");
    EXPECT_THAT(bundleScene(gltf).bundle.files,
                UnorderedElementsAre(Key("s.gltf"), Key("tex.png"), Key("sub/tex.png")));
}

TEST_F(SceneBundleTest, TakesImagesBesideTheScenesFolderAndNothingElse) {
    const fs::path gltf = put(
        "models/s.gltf", R"({"nodes": [{}], "images": [{"uri": "../textures/tex.png"}, {"uri": "../key"}]})");
    put("textures/tex.png", "tex");
    put("key", "secret");
    const BundledScene scene = bundleScene(gltf);
    EXPECT_EQ(scene.bundle.entry, "models/s.gltf");
    EXPECT_THAT(scene.bundle.files, UnorderedElementsAre(Key("models/s.gltf"), Key("textures/tex.png")));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("/images/1/uri"));
}

TEST_F(SceneBundleTest, LeavesOutMissingFilesThatNothingNeeds) {
    const fs::path gltf =
        put("s.gltf", R"({"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"material": 0}]}],
        "materials": [{"occlusionTexture": {"index": 0}, "emissiveTexture": {"index": 0},
                       "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}},
                      {"normalTexture": {"index": 0}}],
        "textures": [{"source": 0}, {"source": 1, "extensions": {"EXT_texture_webp": {"source": 0}}}],
        "images": [{"uri": "gone.webp"}, {"uri": "there.png"}],
        "accessors": [{"bufferView": 0}], "bufferViews": [{"buffer": 0}], "buffers": [{"uri": "walk.bin"}],
        "animations": [{"name": "Walk", "samplers": [{"input": 0, "output": 0}]}]})");
    put("there.png", "png");
    JobSpec job;
    job.motion.animation = "none";
    EXPECT_THAT(bundleScene(gltf, {}, job).bundle.files,
                UnorderedElementsAre(Key("s.gltf"), Key("there.png")));
    EXPECT_EQ(bundleScene(gltf, {}, job).warnings.size(), 2u);
    job.motion.animation = "Walk";
    EXPECT_THAT(errorOf([&] { bundleScene(gltf, {}, job); }).what(), HasSubstr("/buffers/0/uri"));
    job.motion.animation = "none";
    job.strict = true;
    EXPECT_EQ(codeOf([&] { bundleScene(gltf, {}, job); }), ErrorCode::invalidArgument);
}

TEST_F(SceneBundleTest, NeedsTheImagesOfWhatIsShownAlone) {
    const auto faultOfScene = [&](const std::string& material, const std::string& more, JobSpec job = {}) {
        const fs::path gltf =
            put("s.gltf",
                R"({"nodes": [{"mesh": 0}, {"children": [0]}, {}], "meshes": [{"primitives": [{"material": 0,
                "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}}}]}],
                "extensions": {"KHR_materials_variants": {"variants": [{"name": "Dry"}, {"name": "Wet"}]}},
                "textures": [{"source": 0}], "images": [{"uri": "gone.png"}], "materials": [)" +
                    material + ", {\"normalTexture\": {\"index\": 0}}]" + more + "}");
        try {
            bundleScene(gltf, {}, job);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string plain = "{}", clearcoat = R"({"extensions": {"KHR_materials_clearcoat": {
        "clearcoatTexture": {"index": 0}, "clearcoatFactor": )";
    EXPECT_EQ(faultOfScene(clearcoat + "0}}}", ""), "") << "a factor hides it";
    EXPECT_THAT(faultOfScene(clearcoat + "0.5}}}", ""), HasSubstr("/images/0/uri"));
    EXPECT_EQ(faultOfScene(plain, ""), "") << "another variant's";
    JobSpec wet, dry;
    wet.variant = "Wet", dry.variant = "Dry";
    EXPECT_THAT(faultOfScene(plain, "", wet), HasSubstr("/images/0/uri"));
    EXPECT_EQ(faultOfScene(plain, "", dry), "");
    EXPECT_EQ(faultOfScene(plain, R"(, "scenes": [{"nodes": [2]}, {"nodes": [1]}])", wet), "")
        << "another scene's";
    EXPECT_THAT(faultOfScene(plain, R"(, "scenes": [{"nodes": [2]}, {"nodes": [1]}], "scene": 1)", wet),
                HasSubstr("/images/0/uri"));
    EXPECT_EQ(faultOfScene(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {}}})",
                           ""),
              "")
        << "what glossiness replaces";
}

TEST_F(SceneBundleTest, LeavesReferencesAboveAllFoldersToWhoNeedsThem) {
    std::string far = "x.png";
    for (int i = 0; i < 100; ++i) far.insert(0, "../");
    const fs::path gltf = put("s.gltf", R"({"nodes": [{}], "images": [{"uri": ")" + far + "\"}]}");
    EXPECT_THAT(bundleScene(gltf).warnings.at(0), HasSubstr("is above all folders"));
    EXPECT_THAT(faultOfUri(far), HasSubstr("is above all folders"));
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
