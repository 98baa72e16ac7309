#include <gmock/gmock.h>

#include <cmath>

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

TEST_F(EnvironmentTest, ReadsExrAndKeepsWhatTexelsThatAreNoRadianceHave) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    inf = std::numeric_limits<float>::infinity();
    const FloatImage image{
        4,
        2,
        {"R", "G", "B"},
        {{1, -1, 5, inf, 0, 0, 0, 7}, {2, 1, 5, 1, 0, 0, 0, -inf}, {3, 1, nan, 2, 0, 0, 0, inf}}};
    writeExr(folder / "sky.EXR", image);
    loadEnvironment(scene, folder / "sky.EXR");
    EXPECT_THAT(scene.environment.image.rgbaFloat,
                ElementsAre(1, 2, 3, 1, 0, 1, 1, 1, 0, 0, 0, 1, 7, 1, 2, 1,  //
                            0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 7, 0, 7, 1));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].instead,
              "4 texels that are not finite or negative: 1 that are not a number are black, 2 have an "
              "infinite channel, "
              "which becomes the largest finite value, 1 have a negative channel, which becomes 0");
    EXPECT_EQ(scene.sanitisedTexels, 4u);
}

TEST_F(EnvironmentTest, SaysThatAPictureOfAnotherShapeIsStretched) {
    writeExr(folder / "wide.exr", {4, 1, {"Y"}, {{1, 1, 1, 1}}});
    loadEnvironment(scene, folder / "wide.exr");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0].instead, HasSubstr("stretched over the sphere: it is 4 times as wide"));
}

// 8 and 16 bits, sRGB; 55 / 255 is 0.0382 of white.
TEST_F(EnvironmentTest, ReadsPicturesForDisplays) {
    writeBytes(folder / "sky.png", encodePng(2, 1, 4, 8, {255, 55, 0, 255, 255, 255, 255, 51}));
    writeBytes(folder / "deep.PNG", encodePng(2, 1, 3, 16, {65535, 55 * 257, 0, 0, 0, 0}));
    for (const char* name : {"sky.png", "deep.PNG"}) {
        loadEnvironment(scene, folder / name);
        const std::vector<float>& texels = scene.environment.image.rgbaFloat;
        ASSERT_EQ(texels.size(), 8u);
        EXPECT_EQ(texels[0], 1);
        EXPECT_NEAR(texels[1], std::pow((55 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
        EXPECT_EQ(texels[2], 0);
        EXPECT_EQ(texels[4], name[0] == 's' ? 0.2f : 0) << "black shows through";
        EXPECT_EQ(texels[7], 1);
        EXPECT_TRUE(scene.environment.image.rgba8.empty());
    }
    EXPECT_TRUE(scene.warnings.empty());
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

// Two texels of 1 in each channel under a header.
std::vector<float> texelsUnder(const std::string& lines, const TemporaryFolder& folder, Scene& scene) {
    writeText(folder / "sky.hdr", "#?RADIANCE\n" + lines + "\n-Y 1 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x81");
    loadEnvironment(scene, folder / "sky.hdr");
    return scene.environment.image.rgbaFloat;
}

TEST_F(EnvironmentTest, DividesRadianceFilesByWhatTheyWereMultipliedBy) {
    EXPECT_THAT(texelsUnder("EXPOSURE=0.5\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 0.25\n", folder, scene),
                ElementsAre(8, 8, 8, 1, 8, 8, 8, 1));
    EXPECT_THAT(texelsUnder("EXPOSURE=2\nCOLORCORR= 0.5 +1.0 2\nCOLORCORR=1 1 2\nSOFTWARE=x\nno assignment\n",
                            folder, scene),
                ElementsAre(1, 0.5f, 0.125f, 1, 1, 0.5f, 0.125f, 1));
    EXPECT_TRUE(scene.warnings.empty());
    for (const char* line :
         {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=bright\n", "EXPOSURE=nan\n",
          "EXPOSURE=1e-200\nEXPOSURE=1e-200\n", "COLORCORR=1 1\n", "COLORCORR=1 0 1\n", "PRIMARIES=1 2 3\n",
          "FORMAT=other\n", "PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3\n", "PIXASPECT=0\n"})
        EXPECT_THAT(errorOf([&] { texelsUnder(line, folder, scene); }).what(), HasSubstr("sky.hdr")) << line;
}

TEST_F(EnvironmentTest, WarnsOfBlanksRoundAFormatUnlessStrict) {
    for (const char* line :
         {"FORMAT= 32-bit_rle_rgbe\n", "FORMAT=32-bit_rle_rgbe \n", "FORMAT\t=32-bit_rle_rgbe\n"}) {
        scene = {};
        EXPECT_THAT(texelsUnder(line, folder, scene), ElementsAre(1, 1, 1, 1, 1, 1, 1, 1)) << line;
        ASSERT_EQ(scene.warnings.size(), 1u) << line;
        EXPECT_EQ(scene.warnings[0].where, "sky.hdr");
        EXPECT_THAT(scene.warnings[0].instead, HasSubstr("FORMAT"));
        EXPECT_THAT(errorOf([&] { loadEnvironment(scene, folder / "sky.hdr", true); }).what(),
                    HasSubstr("sky.hdr: its header's FORMAT has blanks"));
    }
    texelsUnder("FORMAT=32-bit_rle_rgbe\r\n", folder, scene = {});
    EXPECT_NO_THROW(loadEnvironment(scene, folder / "sky.hdr", true));
    EXPECT_TRUE(scene.warnings.empty()) << "a line of Windows is none";
}

TEST_F(EnvironmentTest, ConvertsThePrimariesOfRadianceFiles) {
    const auto expectTexel = [&](const std::string& lines, std::array<double, 3> color) {
        const std::vector<float> texels = texelsUnder(lines, folder, scene);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(texels[c], color[c], 2e-5) << lines << c;
    };
    // White stays white; XYZ of 1 is Radiance's white.
    expectTexel("PRIMARIES=.713 .293 .165 .83 .128 .044 .32168 .33767\n", {1, 1, 1});
    expectTexel("FORMAT=32-bit_rle_xyze\n", {1, 1, 1});
    expectTexel("PRIMARIES= 0 0 0 0 0 0 0 0\n", {1, 1, 1});
    // Twice the red of ACEScg: its first column once more.
    expectTexel("COLORCORR=.5 1 1\nPRIMARIES=.713 .293 .165 .83 .128 .044 .32168 .33767\n",
                {2.705051, 0.869743, 0.975997});
    EXPECT_TRUE(scene.warnings.empty());
    texelsUnder("PIXASPECT=2\n", folder, scene);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0].instead, HasSubstr("1 times as wide as high"));
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
    EXPECT_THAT(faultOf(folder / "sky.png"), HasSubstr("sky.png: the image cannot be decoded"));
    writeText(folder / "sky.tif", "");
    EXPECT_THAT(faultOf(folder / "sky.tif"),
                HasSubstr("sky.tif: an environment must be a .hdr, .exr, .png or .jpg file"));
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
