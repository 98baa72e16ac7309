#include <gmock/gmock.h>

#include "shared/image/exr.h"
#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct EnvironmentTest : testing::Test {
    TemporaryFolder folder;
    Scene scene;
    std::string faultOf(const std::filesystem::path& path) {
        return errorOf([&] { loadEnvironment(scene, path); }).what();
    }
};

TEST_F(EnvironmentTest, ReadsRadianceFiles) {
    // Two flat RGBE pixels: mantissas over 256 times 2 to the exponent less 128.
    writeText(folder / "sky.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                                      "\x80\x40\x20\x82" + std::string("\x80\x80\x80\x81", 4));
    loadEnvironment(scene, folder / "sky.hdr");
    EXPECT_TRUE(scene.hasEnvironment());
    EXPECT_EQ(scene.environment.image.width, 2u);
    EXPECT_THAT(scene.environment.image.rgbaFloat, ElementsAre(2, 1, 0.5f, 1, 1, 1, 1, 1));
    EXPECT_EQ(scene.environment.name, "sky.hdr");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(EnvironmentTest, ReadsExrAndBlackensTexelsThatAreNoRadiance) {
    FloatImage image{
        3, 1, {"R", "G", "B"}, {{1, -1, 5}, {2, 1, 5}, {3, 1, std::numeric_limits<float>::quiet_NaN()}}};
    writeExr(folder / "sky.EXR", image);
    loadEnvironment(scene, folder / "sky.EXR");
    EXPECT_THAT(scene.environment.image.rgbaFloat, ElementsAre(1, 2, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0].instead, HasSubstr("2 texels"));
}

TEST_F(EnvironmentTest, ReadsBothKindsOfRuns) {
    const std::string header = "#?RGBE\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n";
    // Sixteen columns: per channel a run of 15 and one byte as it is.
    std::string runs = header + "-Y 1 +X 16\n" + std::string("\x02\x02\x00\x10", 4);
    for (const char* value : {"\x80", "\x40", "\x20", "\x82"}) {
        runs += std::string("\x8f") + value + "\x01" + value;
    }
    writeText(folder / "runs.hdr", runs);
    loadEnvironment(scene, folder / "runs.hdr");
    EXPECT_EQ(scene.environment.image.rgbaFloat.size(), 64u);
    EXPECT_EQ(scene.environment.image.rgbaFloat[60], 2);
    // The older kind: one pixel, then three times the same.
    writeText(folder / "old.hdr", header + "-Y 1 +X 4\n\x80\x40\x20\x82\x01\x01\x01\x03");
    loadEnvironment(scene, folder / "old.hdr");
    EXPECT_EQ(scene.environment.image.rgbaFloat.size(), 16u);
    EXPECT_EQ(scene.environment.image.rgbaFloat[13], 1);
    runs.resize(runs.size() - 1);
    writeText(folder / "cut.hdr", runs);
    EXPECT_THAT(faultOf(folder / "cut.hdr"), HasSubstr("cut.hdr: the picture is cut short"));
    writeText(folder / "long.hdr", header + "-Y 1 +X 4\n\x80\x40\x20\x82\x01\x01\x01\x04");
    EXPECT_THAT(faultOf(folder / "long.hdr"), HasSubstr("does not fit its row"));
    writeText(folder / "zero.hdr", header + "-Y 0 +X 4\n");
    EXPECT_THAT(faultOf(folder / "zero.hdr"), HasSubstr("-Y height +X width"));
}

TEST_F(EnvironmentTest, NamesWhatIsWrong) {
    EXPECT_THAT(faultOf(folder / "absent.hdr"), HasSubstr("absent.hdr: there is no such file"));
    writeText(folder / "junk.hdr", "#?RADIANCE\nnonsense");
    EXPECT_THAT(faultOf(folder / "junk.hdr"), HasSubstr("junk.hdr: "));
    writeText(folder / "claim.hdr", "#?RADIANCE\n\n-Y 1 +X 222222202\n");
    EXPECT_THAT(faultOf(folder / "claim.hdr"),
                HasSubstr("222222202 x 1 texels, more than its 30 bytes can hold"));
    writeText(folder / "junk.exr", "nonsense");
    EXPECT_THAT(faultOf(folder / "junk.exr"), HasSubstr("junk.exr"));
    writeText(folder / "sky.png", "");
    EXPECT_THAT(faultOf(folder / "sky.png"),
                HasSubstr("sky.png: an environment must be a .hdr or .exr file"));
    EXPECT_FALSE(scene.hasEnvironment());
}

TEST_F(EnvironmentTest, ReadsTheSharedSkies) {
    const std::filesystem::path sky =
        std::filesystem::path(TILEFARM_SHARED_DATA) / "environments/chinese_garden_1k.hdr";
    if (!std::filesystem::exists(sky)) {
        GTEST_SKIP() << "no shared data";
    }
    loadEnvironment(scene, sky);
    EXPECT_EQ(scene.environment.image.width, 1024u);
    EXPECT_EQ(scene.environment.image.height, 512u);
    EXPECT_GT(scene.environment.image.rgbaFloat[0], 0);
}

}  // namespace
}  // namespace tilefarm
