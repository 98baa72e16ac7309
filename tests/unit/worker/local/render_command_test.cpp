#include "worker/local/render_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "shared/image/exr.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

struct RenderCommandTest : testing::Test {
    RenderCommandTest() {
        render.files.entry = std::filesystem::path(std::getenv("TILEFARM_TEST_DATA")) / "tiny.gltf";
        render.spec.image = {40, 24, 16};
        render.spec.stop.samples = 4;
        render.exr = folder / "out.exr";
    }
    ~RenderCommandTest() override { std::fclose(progress); }
    void run() {
        runLocalRender(
            render, [] { return std::make_unique<FakeBackend>(); }, clock, progress);
    }
    std::string printed() {
        std::rewind(progress);
        std::string text(4096, '\0');
        text.resize(std::fread(text.data(), 1, text.size(), progress));
        return text;
    }

    TemporaryFolder folder;
    FakeClock clock;
    std::FILE* progress = std::tmpfile();
    LocalRender render;
};

TEST_F(RenderCommandTest, WritesThePictureWithItsAttributes) {
    run();
    const FloatImage image = readExr(render.exr);
    EXPECT_EQ(image.width, 40u);
    EXPECT_EQ(image.height, 24u);
    // Pixel (17, 3) lies in the second tile; all its passes have means near 0.25 (x + 3 y).
    EXPECT_NEAR(image.plane("R")[3 * 40 + 17], 0.25 * (17 + 9), 0.01);
    EXPECT_EQ(image.plane("samples.X")[0], 4.0f);
    EXPECT_EQ(readExrAttributes(render.exr).at("job"), "local");
}

TEST_F(RenderCommandTest, WritesPngAndReportWhereAskedTo) {
    render.png = folder / "out.png";
    render.report = folder / "out.json";
    run();
    EXPECT_GT(std::filesystem::file_size(render.png), 100u);
    std::ifstream in(render.report);
    const nlohmann::json report = nlohmann::json::parse(in);
    EXPECT_EQ(report["samples"], 40 * 24 * 4);
    EXPECT_TRUE(report["scene"]["files"].contains("tiny.gltf"));
}

TEST_F(RenderCommandTest, PrintsALineForEveryLevelAndEveryWarning) {
    run();
    const std::string text = printed();
    EXPECT_THAT(text, testing::HasSubstr("warning: materials/0: KHR_x: left out\n"));
    EXPECT_THAT(text, testing::HasSubstr("25.0 %  1 samples"));
    EXPECT_THAT(text, testing::HasSubstr("100.0 %  4 samples  relative error"));
}

TEST_F(RenderCommandTest, RefusesAFolderThatIsNotThereBeforeItRenders) {
    render.png = folder.path() / "nowhere" / "out.png";
    const Error error = errorOf([&] { run(); });
    EXPECT_THAT(error.what(), testing::HasSubstr("nowhere/out.png"));
    EXPECT_FALSE(std::filesystem::exists(render.exr));
}

TEST_F(RenderCommandTest, NamesASceneThatIsNotThere) {
    render.files.entry = folder / "missing.glb";
    EXPECT_THAT(errorOf([&] { run(); }).what(), testing::HasSubstr("missing.glb"));
}

TEST_F(RenderCommandTest, RefusesOptionsThatAJobCouldNotHave) {
    render.spec.image.width = 40000;
    render.spec.stop.samples = (1u << 24) + 1;
    EXPECT_EQ(errorOf([&] { requireValid(render); }).faults.size(), 2u);
}

}  // namespace
}  // namespace tilefarm
