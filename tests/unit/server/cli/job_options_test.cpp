#include "server/cli/job_options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "server/cli/commands.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

JobSpec parsed(std::vector<std::string> words) {
    CLI::App app;
    JobSpec spec;
    addJobOptions(app, spec);
    std::reverse(words.begin(), words.end());
    app.parse(words);
    return spec;
}

TEST(JobOptions, SetEveryFieldOfAJob) {
    const JobSpec spec = parsed({"--name",        "n",  "--camera",         "Cam", "--width",   "100",
                                 "--height",      "50", "--tile-size",      "16",  "--seed",    "4294967295",
                                 "--max-bounces", "3",  "--roulette-start", "2",   "--samples", "7",
                                 "--priority",    "9",  "--frames",         "3-5"});
    JobSpec expected;
    expected.name = "n", expected.camera = "Cam";
    expected.image = {100, 50, 16};
    expected.settings.seed = 4294967295u;
    expected.settings.maxBounces = 3;
    expected.settings.rouletteStart = 2;
    expected.stop.samples = 7;
    expected.priority = 9;
    expected.frames = {3, 3};
    EXPECT_EQ(spec, expected);
}

TEST(JobOptions, KeepTheDefaultsOfTheApi) {
    EXPECT_EQ(parsed({}), JobSpec{});
}

TEST(JobOptions, RefuseWhatIsOutOfRange) {
    for (const char* words : {"--width=0", "--width=32769", "--width=-1", "--width=x", "--samples=0",
                              "--priority=101", "--frames=x", "--sampels=1"})
        EXPECT_THROW(parsed({words}), CLI::ParseError) << words;
}

TEST(Frames, AreOneOrARange) {
    EXPECT_EQ(framesFrom("7"), (FrameRange{7, 1}));
    EXPECT_EQ(framesFrom("1-240"), (FrameRange{1, 240}));
    EXPECT_EQ(framesFrom("-5--1"), (FrameRange{-5, 5}));
    EXPECT_EQ(framesFrom("-5-5"), (FrameRange{-5, 11}));
    for (const char* bad :
         {"", "5-4", "1-", "-", "1-2-3", "1..2", "0-100000", "2147483648", "9999999999999999999"})
        EXPECT_EQ(codeOf([&] { framesFrom(bad); }), ErrorCode::invalidArgument) << bad;
}

TEST(OptionName, SplitsCamelCase) {
    EXPECT_EQ(optionName("samples"), "--samples");
    EXPECT_EQ(optionName("maxBounces"), "--max-bounces");
}

TEST(Numbered, PutsTheFrameWhereTheHashesAreOrBeforeTheSuffix) {
    EXPECT_EQ(numbered("a/out.exr", 7), "a/out.0007.exr");
    EXPECT_EQ(numbered("a/o-######.exr", 7), "a/o-000007.exr");
    EXPECT_EQ(numbered("#.png", 123), "123.png");
    EXPECT_EQ(numbered("out##", 5), "out05");
    EXPECT_EQ(numbered("a.b.exr", 12345), "a.b.12345.exr");
}

}  // namespace
}  // namespace tilefarm
