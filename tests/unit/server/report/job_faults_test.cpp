#include "server/report/job_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

JobRow job() {
    JobRow row;
    row.outlineJson = R"({"settings": {"seed": 9}})";
    row.pixelSamplesMerged = 1000;
    return row;
}

TEST(JobFaults, WhatTheRulesOfTheJobLeaveOutIsNone) {
    JobRow row = job();
    row.truncatedPaths = 10;
    row.truncatedThroughput = 5;
    row.clampedSamples = 3;
    row.clampedLuminance = 40;
    EXPECT_FALSE(isFlagged(row));
    EXPECT_THAT(faultsOf(row), IsEmpty());
    EXPECT_EQ(numericsOf(row)["truncatedShare"], 0.01);
    EXPECT_THAT(noticesOf(row),
                ElementsAre(HasSubstr(
                    "ended 1 % of the paths, which still carried 0.5 % of the initial throughput")));
}

TEST(JobFaults, NothingIsNoticedWhereNothingIsMissing) {
    EXPECT_THAT(noticesOf(job()), IsEmpty());
}

TEST(JobFaults, DroppedSamplesFlagTheJobAndAreNamed) {
    JobRow row = job();
    row.droppedSamples = 2;
    row.faultSamples = {"1 12 34 56"};
    EXPECT_TRUE(isFlagged(row));
    EXPECT_THAT(faultsOf(row), ElementsAre(HasSubstr("2 samples were NaN or infinite")));
    EXPECT_EQ(numericsOf(row)["samples"],
              nlohmann::json::parse(R"([{"frame": 1, "x": 12, "y": 34, "sample": 56, "seed": 9}])"));
}

TEST(JobFaults, RejectedPathsFlagTheJob) {
    JobRow row = job();
    row.rejectedPaths = 7;
    EXPECT_TRUE(isFlagged(row));
    EXPECT_THAT(faultsOf(row), ElementsAre(HasSubstr("7 paths")));
}

TEST(JobFaults, ComeBehindWhyTheJobFailed) {
    JobRow row = job();
    row.faults = {"the scene is gone"};
    row.droppedSamples = 1;
    row.rejectedPaths = 1;
    EXPECT_THAT(faultsOf(row),
                ElementsAre("the scene is gone", HasSubstr("1 sample was"), HasSubstr("1 path ")));
}

}  // namespace
}  // namespace tilefarm
