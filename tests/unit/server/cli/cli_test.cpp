// The program as a user meets it: words in, text and exit code out, against a farm that behaves.
#include "server/cli/cli.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/file/durable_file.h"
#include "shared/image/exr.h"
#include "shared/job/wire.h"
#include "tests/support/fake_clock.h"
#include "tests/support/fake_farm.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

struct CliTest : testing::Test {
    FakeFarm farm;
    TemporaryFolder folder;
    FakeClock clock;
    std::function<void()> whileWaiting = [] {};
    std::string out, err;

    void SetUp() override {
        writeDurably(folder / "scene.gltf", R"({"buffers": [{"uri": "scene.bin"}]})");
        writeDurably(folder / "scene.bin", "buffer bytes");
        writeDurably(folder / "sky.hdr", "sky bytes");
    }

    int run(std::vector<std::string> words) { return runAt(farm.url(), std::move(words)); }
    int runAt(const std::string& url, std::vector<std::string> words) {
        std::ostringstream outStream, errStream;
        const auto sleep = [&](Milliseconds time) {
            clock.advance(time);
            whileWaiting();
        };
        words.insert(words.begin(), {"--server", url});
        const int code = runCli(words, {outStream, errStream, false, clock, sleep});
        out = outStream.str(), err = errStream.str();
        return code;
    }
    std::string path(const char* name) { return (folder / name).string(); }
};

TEST_F(CliTest, SubmitUploadsTheSceneAndPrintsTheJobAlone) {
    EXPECT_EQ(run({"submit", path("scene.gltf"), "--environment", path("sky.hdr"), "--width", "100",
                   "--samples", "8"}),
              kDone);
    EXPECT_EQ(out, "1\n");
    EXPECT_EQ(farm.blobs().size(), 3u);
    const json sent = json::parse(farm.seen().back().body);
    EXPECT_EQ(sent["name"], "scene");
    EXPECT_EQ(sent["image"]["width"], 100);
    EXPECT_EQ(sent["stop"]["samples"], 8);
    EXPECT_EQ(sent["scene"]["entry"], "scene.gltf");
    EXPECT_EQ(sent["scene"]["environment"], "environment/sky.hdr");
}

TEST_F(CliTest, SubmitUploadsOnlyWhatIsMissing) {
    run({"submit", path("scene.gltf")});
    EXPECT_EQ(farm.count("PUT", "/v1/blobs/"), 2u);
    writeDurably(folder / "scene.bin", "other bytes");
    EXPECT_EQ(run({"submit", path("scene.gltf")}), kDone);
    EXPECT_EQ(farm.count("PUT", "/v1/blobs/"), 3u);
    EXPECT_EQ(out, "2\n");
}

TEST_F(CliTest, SubmitWarnsOfFilesThatItLeavesOutUnlessStrict) {
    writeDurably(folder / "scene.gltf", R"({"nodes": [{}], "images": [{"uri": "gone.png"}]})");
    EXPECT_EQ(run({"submit", path("scene.gltf")}), kDone);
    EXPECT_THAT(err, AllOf(HasSubstr("warning: "), HasSubstr("/images/0/uri: there is no file"),
                           HasSubstr("gone.png")));
    EXPECT_EQ(run({"submit", path("scene.gltf"), "--strict"}), kUsage);
    EXPECT_THAT(err, HasSubstr("/images/0/uri"));
}

TEST_F(CliTest, SubmitWaitsAndBringsThePicturesHome) {
    farm.setImage("the picture");
    EXPECT_EQ(run({"submit", path("scene.gltf"), "-o", path("out.exr"), "--png", path("out.png"), "--tone",
                   "aces", "--exposure", "-1.5"}),
              kDone);
    EXPECT_EQ(out, "1\n");
    EXPECT_EQ(readWhole(folder / "out.exr").size(), 11u);
    EXPECT_TRUE(fs::exists(folder / "out.png"));
    EXPECT_EQ(farm.count("GET", "/v1/jobs/1/frames/0/image.png?exposure=-1.5&tone=aces"), 1u);
    EXPECT_THAT(err, AllOf(HasSubstr("100 %  completed"), HasSubstr("relative error 0.1667"),
                           HasSubstr("note: the bounce limit ended paths\n")));
}

TEST_F(CliTest, SubmitNumbersThePicturesOfSeveralFrames) {
    EXPECT_EQ(run({"submit", path("scene.gltf"), "--frames", "9-11", "-o", path("f.exr")}), kDone);
    for (const char* name : {"f.0009.exr", "f.0010.exr", "f.0011.exr"})
        EXPECT_TRUE(fs::exists(folder / name)) << name;
}

TEST_F(CliTest, SubmitFailsWithTheJobAndSaysWhy) {
    farm.endJobsAs("failed");
    EXPECT_EQ(run({"submit", path("scene.gltf"), "--wait"}), kFailed);
    EXPECT_THAT(err, AllOf(HasSubstr("the job is failed"), HasSubstr("no light in the scene")));
    farm.endJobsAs("canceled");
    EXPECT_EQ(run({"submit", path("scene.gltf"), "-o", path("out.exr")}), kFailed);
    EXPECT_FALSE(fs::exists(folder / "out.exr"));
}

TEST_F(CliTest, SubmitChecksBeforeItSendsAnything) {
    EXPECT_EQ(run({"submit", path("scene.gltf"), "--tile-size", "12"}), kUsage);
    EXPECT_THAT(err, HasSubstr("/image/tileSize"));
    fs::remove(folder / "scene.bin");
    EXPECT_EQ(run({"submit", path("scene.gltf")}), kUsage);
    EXPECT_THAT(err, HasSubstr("/buffers/0/uri"));
    EXPECT_EQ(run({"submit", path("absent.gltf")}), kUsage);
    EXPECT_EQ(run({"submit", path("sky.hdr")}), kUsage);
    EXPECT_TRUE(farm.seen().empty());
}

TEST_F(CliTest, WaitingRidesOutAServerThatRestarts) {
    run({"submit", path("scene.gltf")});
    int waits = 0;
    whileWaiting = [&] {
        if (++waits == 1) farm.answerAll(503, R"({"detail": "starting"})");
        if (waits == 20) farm.clear();
    };
    EXPECT_EQ(run({"wait", "1"}), kDone);
    EXPECT_THAT(err, HasSubstr("starting; trying again"));
    EXPECT_EQ(err.find("starting"), err.rfind("starting"));  // said once
    EXPECT_GE(waits, 20);
}

TEST_F(CliTest, WaitingGivesUpOnAServerThatStaysAway) {
    run({"submit", path("scene.gltf")});
    whileWaiting = [&] { farm.answerAll(503, R"({"detail": "starting"})"); };
    EXPECT_EQ(run({"wait", "1"}), kUnreachable);
}

TEST_F(CliTest, ShowsJobsAndWorkers) {
    run({"submit", path("scene.gltf"), "--name", "ki\xC3\xBCtchen"});
    EXPECT_EQ(run({"jobs"}), kDone);
    EXPECT_THAT(out, AllOf(HasSubstr("JOB  STATE"), HasSubstr("queued"), HasSubstr("ki\xC3\xBCtchen")));
    EXPECT_EQ(run({"jobs", "--json", "--state", "queued"}), kDone);
    EXPECT_EQ(json::parse(out).size(), 1u);
    EXPECT_EQ(run({"job", "1"}), kDone);
    EXPECT_THAT(out, AllOf(HasSubstr("job 1  running"), HasSubstr("640 x 360, 64 samples, frame 0\n"),
                           HasSubstr("scene.gltf")));
    EXPECT_EQ(run({"job", "1", "--json"}), kDone);
    EXPECT_EQ(json::parse(out)["id"], "1");
    EXPECT_EQ(run({"workers"}), kDone);
    EXPECT_THAT(out, AllOf(HasSubstr("w1"), HasSubstr("llvmpipe")));
}

TEST_F(CliTest, MovesJobs) {
    run({"submit", path("scene.gltf")});
    EXPECT_EQ(run({"pause", "1"}), kDone);
    EXPECT_EQ(out, "job 1 is paused\n");
    EXPECT_EQ(run({"resume", "1"}), kDone);
    EXPECT_EQ(run({"cancel", "1"}), kDone);
    EXPECT_EQ(out, "job 1 is canceled\n");
    EXPECT_EQ(run({"cancel", "77"}), kFailed);
    EXPECT_THAT(err, HasSubstr("no such job"));
}

TEST_F(CliTest, DownloadsByTheSuffixOfTheFile) {
    run({"submit", path("scene.gltf"), "--frames", "5-6"});
    EXPECT_EQ(run({"download", "1", "-o", path("a.exr")}), kDone);
    EXPECT_EQ(farm.count("GET", "/v1/jobs/1/frames/5/image.exr"), 1u);
    EXPECT_EQ(run({"download", "1", "--frame", "6", "-o", path("a.PNG")}), kDone);
    EXPECT_EQ(farm.seen().back().path, "/v1/jobs/1/frames/6/image.png?exposure=0&tone=pbrNeutral");
    EXPECT_EQ(run({"download", "1", "--denoised", "-o", path("a.png")}), kDone);
    EXPECT_EQ(farm.seen().back().path, "/v1/jobs/1/frames/5/image.png?exposure=0&tone=pbrNeutral&denoised=1");
    EXPECT_EQ(run({"download", "1", "-o", path("a.jpg")}), kUsage);
    EXPECT_EQ(run({"download", "1", "-o", path("no/such/a.exr")}), kFailed);
}

TEST_F(CliTest, ExitCodesTellUsageFromAServerThatIsAway) {
    EXPECT_EQ(run({}), kUsage);
    EXPECT_EQ(run({"fly"}), kUsage);
    EXPECT_EQ(run({"job"}), kUsage);
    EXPECT_EQ(run({"job", "1", "--tone", "x"}), kUsage);
    EXPECT_EQ(run({"--help"}), kDone);
    EXPECT_EQ(run({"submit", "--help"}), kDone);
    EXPECT_EQ(runAt("nonsense", {"jobs"}), kUsage);
    std::string gone;
    {
        const FakeFarm other;
        gone = other.url();
    }
    EXPECT_EQ(runAt(gone, {"jobs"}), kUnreachable);
    EXPECT_THAT(err, HasSubstr(gone));
}

TEST_F(CliTest, OptionsOfTheServerMayStandAfterTheCommandToo) {
    EXPECT_EQ(runAt("http://127.0.0.1:1", {"jobs"}), kUnreachable);
    std::ostringstream o, e;
    EXPECT_EQ(runCli({"jobs", "--server", farm.url()}, {o, e, false, clock, [](Milliseconds) {}}), kDone);
}

TEST_F(CliTest, ListsEveryFaultOfARefusedRequest) {
    farm.answerAll(
        422,
        R"({"detail": "cannot", "errors": [{"pointer": "/a", "message": "is bad"}, {"pointer": "/b", "message": "too"}]})");
    EXPECT_EQ(run({"jobs"}), kFailed);
    EXPECT_EQ(err, "tilefarm: cannot\n  /a is bad\n  /b too\n");
    farm.answerAll(200, R"({"jobs": 7})", "application/json");
    EXPECT_EQ(run({"jobs"}), kFailed);
    EXPECT_EQ(run({"job", "1"}), kFailed);
}

TEST_F(CliTest, SendsATokenFromAFile) {
    writeDurably(folder / "token", "s3cret\n");
    EXPECT_EQ(run({"--token-file", path("token"), "workers"}), kDone);
    EXPECT_EQ(farm.seen().back().authorization, "Bearer s3cret");
    EXPECT_EQ(run({"--token-file", path("absent"), "workers"}), kUsage);
}

struct ImageToolTest : CliTest {
    std::string write(const char* name, float red, float extra) {
        writeExr(folder / name, {2,
                                 1,
                                 {"B", "G", "R", "Z", "normal.X", "normal.Y", "normal.Z"},
                                 {{1, 1}, {1, 1}, {red, 1}, {extra, 4}, {0, 1}, {0, 0}, {1, 0}}});
        return path(name);
    }
};

TEST_F(ImageToolTest, CompareTellsTheDifference) {
    const std::string a = write("a.exr", 1.5f, 0), b = write("b.exr", 1, 0);
    EXPECT_EQ(run({"compare", a, b}), kDone);
    EXPECT_THAT(out, AllOf(HasSubstr("identical        no"), HasSubstr("largest          0.5")));
    EXPECT_EQ(run({"compare", a, b, "--json"}), kDone);
    const json d = json::parse(out);
    EXPECT_DOUBLE_EQ(d["rmse"], std::sqrt(0.25 / 6));
    EXPECT_EQ(d["identical"], false);
}

TEST_F(ImageToolTest, CompareFailsBeyondWhatIsAllowed) {
    const std::string a = write("a.exr", 1.5f, 0), b = write("b.exr", 1, 0), c = write("c.exr", 1, 3);
    EXPECT_EQ(run({"compare", a, b, "--max-relmse", "0.03"}), kFailed);  // 0.25 / 1.0001 / 6 = 0.0417
    EXPECT_EQ(run({"compare", a, b, "--max-relmse", "0.05"}), kDone);
    EXPECT_EQ(run({"compare", b, b, "--identical"}), kDone);
    EXPECT_EQ(run({"compare", a, b, "--identical"}), kFailed);
    EXPECT_EQ(run({"compare", b, c, "--identical"}), kFailed);  // the same picture, another depth
    EXPECT_EQ(run({"compare", b, path("absent.exr")}), kUsage);
}

TEST_F(ImageToolTest, PngShowsPictureLayersAndChannels) {
    const std::string a = write("a.exr", 1, 2);
    for (const char* channel : {"", "normal", "Z"}) {
        const std::string file = path("p.png");
        EXPECT_EQ(run({"png", a, "-o", file, "--channel", channel}), kDone) << channel;
        EXPECT_GT(readWhole(file).size(), 50u);
    }
    EXPECT_EQ(run({"png", a, "-o", path("p.png"), "--channel", "albedo"}), kUsage);
    EXPECT_THAT(err, HasSubstr("no channel 'albedo'"));
}

}  // namespace
}  // namespace tilefarm
