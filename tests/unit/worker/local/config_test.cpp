#include "worker/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

std::variant<WorkerConfig, ExitNow> parse(std::vector<std::string> words) {
    words.insert(words.begin(), "tilefarm-worker");
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return parseCommandLine(static_cast<int>(argv.size()), argv.data());
}

WorkerConfig config(std::vector<std::string> words) {
    auto parsed = parse(std::move(words));
    if (!std::holds_alternative<WorkerConfig>(parsed)) ADD_FAILURE() << "refused";
    return std::get<WorkerConfig>(parsed);
}

int exitCode(std::vector<std::string> words) {
    const auto parsed = parse(std::move(words));
    const auto* exit = std::get_if<ExitNow>(&parsed);
    return exit ? exit->code : -1;
}

TEST(WorkerConfig, AnAgentNeedsAServerAndHasDefaultsForTheRest) {
    EXPECT_EQ(exitCode({}), 2);
    const WorkerConfig parsed = config({"--server", "http://farm:8700"});
    const auto& agent = std::get<AgentConfig>(parsed.command);
    EXPECT_EQ(agent.server, "http://farm:8700");
    EXPECT_FALSE(agent.device.all);
    EXPECT_FALSE(agent.device.index.has_value());
    EXPECT_EQ(agent.wantSeconds, 5);
    EXPECT_EQ(agent.cacheBytes, 20'000'000'000u);
    EXPECT_FALSE(parsed.cache.empty());
}

TEST(WorkerConfig, ReadsEveryOptionOfAnAgent) {
    const TemporaryFolder folder;
    std::ofstream(folder / "token") << "secret \r\nmore";
    const WorkerConfig parsed = config({"--server", "http://farm:1", "--device", "3", "--token-file",
                                        (folder / "token").string(), "--cache", "/tmp/c", "--cache-limit",
                                        "0.5", "--name", "box", "--want-seconds", "2", "--verbose"});
    const auto& agent = std::get<AgentConfig>(parsed.command);
    EXPECT_EQ(agent.device.index, 3u);
    EXPECT_EQ(agent.token, "secret");
    EXPECT_EQ(parsed.cache, "/tmp/c");
    EXPECT_EQ(agent.cacheBytes, 500'000'000u);
    EXPECT_EQ(agent.name, "box");
    EXPECT_EQ(agent.wantSeconds, 2);
    EXPECT_TRUE(parsed.verbose);
    EXPECT_TRUE(
        std::get<AgentConfig>(config({"--server", "http://f:1", "--device", "all"}).command).device.all);
}

TEST(WorkerConfig, ReadsEveryOptionOfARender) {
    const WorkerConfig parsed = config({"render",
                                        "a.glb",
                                        "-o",
                                        "a.exr",
                                        "--png",
                                        "a.png",
                                        "--report",
                                        "a.json",
                                        "--width",
                                        "64",
                                        "--height",
                                        "32",
                                        "--tile-size",
                                        "16",
                                        "--samples",
                                        "9",
                                        "--seed",
                                        "5",
                                        "--max-bounces",
                                        "3",
                                        "--roulette-start",
                                        "2",
                                        "--environment",
                                        "e.hdr",
                                        "--camera",
                                        "Left",
                                        "--frame",
                                        "-2",
                                        "--exposure",
                                        "-1.5",
                                        "--tone",
                                        "aces",
                                        "--device",
                                        "1",
                                        "--validation",
                                        "--cache",
                                        "/tmp/c"});
    const auto& [render, device, validation] = std::get<RenderConfig>(parsed.command);
    EXPECT_EQ(render.files.entry, "a.glb");
    EXPECT_EQ(render.files.environment, "e.hdr");
    EXPECT_EQ(render.exr, "a.exr");
    EXPECT_EQ(render.spec.image, (ImageSpec{64, 32, 16}));
    EXPECT_EQ(render.spec.stop.samples, 9u);
    EXPECT_EQ(render.spec.settings, (RenderSettings{5, 3, 2}));
    EXPECT_EQ(render.spec.camera, "Left");
    EXPECT_EQ(render.spec.frames, (FrameSet{-2, 1}));
    EXPECT_EQ(render.tone.curve, ToneCurve::aces);
    EXPECT_EQ(render.tone.exposure, -1.5f);
    EXPECT_EQ(device.index, 1u);
    EXPECT_TRUE(validation);
    EXPECT_EQ(parsed.cache, "/tmp/c");
}

TEST(WorkerConfig, WrongUsageIsExitCode2) {
    EXPECT_EQ(exitCode({"render"}), 2);
    EXPECT_EQ(exitCode({"render", "a.glb"}), 2);
    EXPECT_EQ(exitCode({"render", "a.glb", "-o", "a.exr", "--tile-size", "7"}), 2);
    EXPECT_EQ(exitCode({"render", "a.glb", "-o", "a.exr", "--samples", "0"}), 2);
    EXPECT_EQ(exitCode({"render", "a.glb", "-o", "a.exr", "--tone", "vivid"}), 2);
    EXPECT_EQ(exitCode({"render", "a.glb", "-o", "a.exr", "--device", "all"}), 2);
    EXPECT_EQ(exitCode({"--server", "http://f:1", "--device", "x"}), 2);
    EXPECT_EQ(exitCode({"--server", "http://f:1", "--token-file", "/nowhere"}), 2);
    EXPECT_EQ(exitCode({"--no-such-option"}), 2);
}

TEST(WorkerConfig, HelpIsExitCode0) {
    EXPECT_EQ(exitCode({"--help"}), 0);
    EXPECT_EQ(exitCode({"render", "--help"}), 0);
    EXPECT_EQ(exitCode({"--version"}), 0);
}

TEST(WorkerConfig, DevicesMayBeAskedForAsJson) {
    EXPECT_TRUE(std::get<DevicesConfig>(config({"devices", "--json"}).command).json);
    EXPECT_FALSE(std::get<DevicesConfig>(config({"devices"}).command).json);
}

}  // namespace
}  // namespace tilefarm
