#include "worker/local/local_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

struct LocalReportTest : testing::Test {
    LocalReportTest() {
        spec.scene = {
            "a.gltf", {{"a.gltf", std::string(64, 'a')}, {"sky.hdr", std::string(64, 'b')}}, "sky.hdr"};
        scene.counts = {12, 3, 2, 4, 5, 0, {3, 1, 24}};
        scene.warnings = {{"KHR_materials_sheen", "materials/3 (Cloth)", "rendered without sheen"}};
        scene.features = {{"environment"}, {"textures"}, {}};
        scene.loadSeconds = 0.5;
        frame.stats = {2.0, 1000, 4000, 7, {3, 250, 50, 20, 5, 8, {{5, 6, 11}}}};
        spec.settings.seed = 9;
        spec.stop.samples = 64;
        FilmTile tile({0, 0, 2, 1});
        for (FilmPixel& pixel : tile.pixels) pixel.mean = {0.03, 0.03, 0.03}, pixel.count = 250;
        frame.tiles = {tile};
        frame.seconds = 2.5;
        ErrorEstimate estimate{.relativeError = 0.25, .low = 0.2, .high = 0.3125, .worstShare = 0.75};
        estimate.worst = {{3, 1, 0.5}};
        estimate.sum = 2;
        frame.errorCurve = {{1, std::nullopt, 0.5, {}}, {2, 0.25, 2.0, estimate}};
    }
    JobSpec spec;
    DeviceName device{"Fake", "fake 1.0"};
    PreparedScene scene;
    RenderedFrame frame;
};

TEST_F(LocalReportTest, HoldsAllThatIsKnown) {
    const nlohmann::json report = localReport(spec, device, scene, frame);
    EXPECT_EQ(report["scene"]["files"]["sky.hdr"], std::string(64, 'b'));
    EXPECT_EQ(report["scene"]["triangles"], 12);
    EXPECT_EQ(report["scene"]["degenerateTriangles"], 5);
    EXPECT_EQ(report["scene"]["lights"], 3);
    EXPECT_EQ(report["scene"]["emissiveGroups"], 1);
    EXPECT_EQ(report["scene"]["emissiveTriangles"], 24);
    EXPECT_EQ(report["device"], "Fake");
    EXPECT_EQ(report["image"]["tileSize"], 128);
    EXPECT_EQ(report["settings"]["maxBounces"], 8);
    EXPECT_EQ(report["environment"]["kind"], "auto");
    EXPECT_EQ(report["lights"].size() + report["materials"].size(), 0u);
    EXPECT_EQ(report["features"]["leftOut"][0], "textures");
    EXPECT_EQ(report["warnings"][0]["where"], "materials/3 (Cloth)");
    EXPECT_EQ(report["prepare"]["loadSeconds"], 0.5);
    EXPECT_EQ(report["samplesPerSecond"], 500.0);
    EXPECT_EQ(report["raysPerSecond"], 2000.0);
    EXPECT_EQ(report["droppedSamples"], 7);
    EXPECT_EQ(report["numerics"]["rejectedPaths"], 3);
    EXPECT_EQ(report["numerics"]["truncatedShare"], 0.25);
    EXPECT_EQ(report["numerics"]["truncatedThroughput"], 0.05);
    EXPECT_THAT(report["notices"][0].get<std::string>(), testing::HasSubstr("25 % of the paths"));
    EXPECT_EQ(report["numerics"]["lightsBehindGlass"], 8);
    EXPECT_THAT(report["notices"][1].get<std::string>(), testing::HasSubstr("8 shadow rays to"));
    EXPECT_EQ(report["numerics"]["clampedSamples"], 20);
    EXPECT_EQ(report["numerics"]["clampedLuminance"], 0.005);
    EXPECT_DOUBLE_EQ(report["numerics"]["clampedPercent"].get<double>(), 25) << "5 of 5 + 15";
    EXPECT_EQ(report["numerics"]["samples"][0],
              (nlohmann::json{{"frame", 0}, {"x", 5}, {"y", 6}, {"sample", 11}, {"seed", 9}}));
    EXPECT_EQ(report["errorCurve"][0]["relativeError"], nullptr);
    EXPECT_EQ(report["errorCurve"][1]["relativeError"], 0.25);
    EXPECT_EQ(report["relativeError"], 0.25);
    EXPECT_EQ(report["errorCurve"][0]["relativeErrorInterval"], nullptr);
    EXPECT_EQ(report["relativeErrorInterval"], (nlohmann::json{0.2, 0.3125}));
    EXPECT_EQ(report["errorTail"],
              (nlohmann::json{{"worstShare", 0.75}, {"pixels", {{{"x", 3}, {"y", 1}, {"share", 0.25}}}}}));
    EXPECT_NE(report["notices"].back().get<std::string>().find("--pixel 3,1"), std::string::npos);
}

TEST_F(LocalReportTest, ADeviceWithoutSecondsHasNoSpeed) {
    frame.stats.deviceSeconds = 0;
    EXPECT_EQ(localReport(spec, device, scene, frame)["raysPerSecond"], 0.0);
}

TEST_F(LocalReportTest, AttributesSayHowAPictureCanBeMadeAgain) {
    const ImageAttributes attributes = localAttributes(spec, device, frame);
    EXPECT_EQ(attributes.at("job"), "local");
    EXPECT_EQ(attributes.at("devices"), "Fake");
    EXPECT_EQ(attributes.at("scene").size(), 64u);
    EXPECT_EQ(nlohmann::json::parse(attributes.at("settings"))["stop"]["samples"], 64);
    JobSpec other = spec;
    other.scene.files["sky.hdr"] = std::string(64, 'c');
    EXPECT_EQ(attributes.at("stopped"), "all 64 samples per pixel taken");
    EXPECT_NE(localAttributes(other, device, frame).at("scene"), attributes.at("scene"));
}

}  // namespace
}  // namespace tilefarm
