#include "worker/local/scene_bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "shared/digest/digest.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

struct SceneBundleTest : testing::Test {
    std::filesystem::path write(const std::string& name, const std::string& text) {
        const auto path = folder / name;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }
    TemporaryFolder folder;
};

TEST_F(SceneBundleTest, HoldsEveryFileThatTheSceneNames) {
    const auto entry = write("scene.gltf", R"({"asset": {"version": "2.0"},
        "buffers": [{"byteLength": 3, "uri": "data%20set.bin"}, {"byteLength": 3, "uri": "data:;base64,AAAA"}],
        "images": [{"uri": "tex/wood.png"}, {"uri": "tex/wood.png"}, {"bufferView": 0}]})");
    write("data set.bin", "bin");
    write("tex/wood.png", "png");
    const auto sky = write("elsewhere/sky.hdr", "hdr");
    const SceneBundle bundle = bundleOf({entry, sky});
    EXPECT_EQ(bundle.entry, "scene.gltf");
    EXPECT_EQ(bundle.environment, "environment/sky.hdr");
    ASSERT_EQ(bundle.files.size(), 4u);
    EXPECT_EQ(bundle.files.at("data set.bin"), sha256Hex(std::string_view("bin")));
    EXPECT_EQ(bundle.files.at("tex/wood.png"), sha256Hex(std::string_view("png")));
    EXPECT_EQ(bundle.files.at("environment/sky.hdr"), sha256Hex(std::string_view("hdr")));
}

TEST_F(SceneBundleTest, LeavesWhatIsNotThereToTheLoaderUnlessStrict) {
    const auto entry =
        write("scene.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": "gone.png"}]})");
    const Error error = errorOf([&] { bundleOf({entry, {}}, true); });
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("scene.gltf"), testing::HasSubstr("/images/0/uri"),
                               testing::HasSubstr("gone.png")));
    EXPECT_EQ(bundleOf({entry, {}}).files.size(), 1u);
}

TEST_F(SceneBundleTest, ReachesAboveTheSceneAsFarAsItsFiles) {
    const auto entry = write("models/scene.gltf", R"({"asset": {"version": "2.0"},
        "images": [{"uri": "../textures/wood.png"}, {"uri": "sub//../near.png"}, {"uri": "../secret.txt"}]})");
    write("textures/wood.png", "wood");
    write("models/near.png", "near");
    write("secret.txt", "secret");
    const SceneBundle bundle = bundleOf({entry, {}});
    EXPECT_EQ(bundle.entry, "models/scene.gltf");
    EXPECT_EQ(bundle.files.size(), 3u);
    EXPECT_EQ(bundle.files.at("textures/wood.png"), sha256Hex(std::string_view("wood")));
    EXPECT_EQ(bundle.files.at("models/near.png"), sha256Hex(std::string_view("near")));
}

TEST_F(SceneBundleTest, AnEnvironmentNeverTakesTheNameOfAnotherFile) {
    const auto entry = write("scene.gltf", R"({"asset": {"version": "2.0"},
        "images": [{"uri": "environment/sky.hdr"}]})");
    write("environment/sky.hdr", "one");
    const SceneBundle bundle = bundleOf({entry, write("elsewhere/sky.hdr", "other")});
    EXPECT_EQ(bundle.environment, "environment/environment/sky.hdr");
    EXPECT_EQ(bundle.files.size(), 3u);
}

}  // namespace
}  // namespace tilefarm
