#include "server/study/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/job/wire.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using nlohmann::json;

json baseJob() {
    JobSpec spec;
    spec.scene.files = {{"a.glb", std::string(64, 'a')}};
    spec.scene.entry = "a.glb";
    spec.image = {.width = 40, .height = 24, .tileSize = 16};
    spec.stop.samples = 64;
    return toJson(spec);
}

json studyOf(const json& knobs) {
    return {{"job", baseJob()}, {"knobs", knobs}};
}

StudyPlan planFor(const json& study) {
    return StudyPlan(studyFromJson(study));
}

std::vector<std::string> faultPlaces(const json& study) {
    std::vector<std::string> places;
    for (const Fault& fault : errorOf([&] { planFor(study); }).faults) places.push_back(fault.pointer);
    return places;
}

std::vector<std::string> labels(const StudyPlan& plan) {
    std::vector<std::string> found;
    for (const StudyVariant& variant : plan.variants()) found.push_back(variant.label);
    return found;
}

const json kTwoKnobs = json::parse(R"([{"path": "settings.clampIndirect", "values": [0, 1, 10]},
                                       {"path": "settings.sampler", "values": ["random", "sobol"]}])");

TEST(StudyPlan, TurnsOneKnobAtATimeAndPassesOverWhatTheBaseHas) {
    const StudyPlan plan = planFor(studyOf(kTwoKnobs));
    EXPECT_THAT(labels(plan),
                testing::ElementsAre("base", "settings.clampIndirect = 1", "settings.clampIndirect = 10",
                                     "settings.sampler = sobol"));
    EXPECT_EQ(plan.variants()[2].settings, json::parse(R"({"settings.clampIndirect": 10})"));
    ASSERT_EQ(plan.cells().size(), 4u * 3);  // 4, 16 and 64 samples
    EXPECT_EQ(plan.cells()[0].samples, 4u);
    EXPECT_EQ(plan.cells()[11].samples, 64u);
    const JobSpec job = plan.job(plan.cells()[10], 3);
    EXPECT_EQ(job.settings.clampIndirect, 10);
    EXPECT_EQ(job.settings.seed, 3u);
    EXPECT_EQ(job.stop.samples, 64u);
    EXPECT_EQ(job.priority, 10);
}

TEST(StudyPlan, MakesAllCombinationsOfAGrid) {
    json study = studyOf(kTwoKnobs);
    study["grid"] = true;
    EXPECT_THAT(labels(planFor(study)),
                testing::ElementsAre("base", "settings.clampIndirect = 1", "settings.clampIndirect = 10",
                                     "settings.sampler = sobol",
                                     "settings.clampIndirect = 1, settings.sampler = sobol",
                                     "settings.clampIndirect = 10, settings.sampler = sobol"));
}

TEST(StudyPlan, TurnsWholeObjectsAndWhatIsNoSetting) {
    const StudyPlan plan = planFor(studyOf(json::parse(
        R"([{"path": "image", "values": [{"width": 20, "height": 12}]}, {"path": "output.denoise", "values": [true]},
            {"path": "image.tileSize", "values": [8]}])")));
    EXPECT_EQ(plan.job(plan.cells()[1], 0).image.width, 20u);
    EXPECT_EQ(plan.job(plan.cells()[1], 0).image.tileSize, 16u);
    EXPECT_TRUE(plan.job(plan.cells()[2], 0).output.denoise);
    EXPECT_EQ(plan.job(plan.cells()[3], 0).image.tileSize, 8u);
}

TEST(StudyPlan, KeepsAReferenceByWhatDecidesItsBits) {
    const StudyPlan plan = planFor(studyOf(kTwoKnobs));
    EXPECT_EQ(plan.reference().stop.samples, 64u * 16);
    EXPECT_EQ(plan.reference().settings.seed, 1'000'000u);
    json study = studyOf(json::parse(R"([{"path": "settings.maxBounces", "values": [1]}])"));
    study["name"] = "another";
    study["job"]["image"]["tileSize"] = 8;
    study["seeds"] = 2;
    EXPECT_EQ(planFor(study).referenceKey(), plan.referenceKey());
    study["reference"] = {{"samples", 2048}};
    EXPECT_NE(planFor(study).referenceKey(), plan.referenceKey());
}

TEST(StudyPlan, RepeatsFromWhatItWrites) {
    json study = studyOf(kTwoKnobs);
    study["samples"] = {9, 3};
    const StudyRequest request = studyFromJson(study);
    EXPECT_EQ(toJson(studyFromJson(toJson(request))), toJson(request));
    EXPECT_THAT(request.samples, testing::ElementsAre(3, 9));
}

TEST(StudyPlan, NamesEveryFaultByItsPlace) {
    using testing::ElementsAre;
    EXPECT_THAT(faultPlaces(json::parse(R"({"knobs": []})")), ElementsAre("/job", "/knobs"));
    EXPECT_THAT(
        faultPlaces(studyOf(json::parse(R"([{"path": "settings.clampIndirect", "values": [1, -1, "x"]}])"))),
        ElementsAre("/knobs/0/values/1", "/knobs/0/values/2"));
    EXPECT_THAT(faultPlaces(studyOf(json::parse(R"([{"path": "settings.clampindirect", "values": [1]}])"))),
                ElementsAre("/knobs/0/values/0"));
    EXPECT_THAT(faultPlaces(studyOf(json::parse(R"([{"path": "lights.0.size", "values": [1]}])"))),
                testing::Each("/knobs/0/values/0"));
    for (const char* taken :
         {"settings.seed", "stop.samples", "settings", "priority", "scene.files", "frames"})
        EXPECT_THAT(faultPlaces(studyOf({{{"path", taken}, {"values", {1}}}})), ElementsAre("/knobs/0/path"))
            << taken;
    json study = studyOf(kTwoKnobs);
    study["seeds"] = 1;
    study["sample"] = 4;
    study["reference"] = {{"seed", 2}};
    study["job"]["settings"]["maxBounces"] = -1;
    EXPECT_THAT(faultPlaces(study), testing::UnorderedElementsAre("/seeds", "/sample", "/reference/seed",
                                                                  "/job/settings/maxBounces"));
}

TEST(StudyPlan, BoundsWhatOneStudyMayTake) {
    json study = studyOf(kTwoKnobs);
    study["job"]["image"] = {{"width", 2000}, {"height", 2000}};
    EXPECT_THAT(faultPlaces(study), testing::Contains("/job/image"));
    json values = json::array();
    for (int i = 1; i <= 32; ++i) values.push_back(i);
    study = studyOf({{{"path", "settings.maxBounces"}, {"values", values}},
                     {{"path", "settings.strata"}, {"values", values}}});
    study["grid"] = true;
    EXPECT_THAT(faultPlaces(study), testing::ElementsAre("/grid"));
}

}  // namespace
}  // namespace tilefarm
