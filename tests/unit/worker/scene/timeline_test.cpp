// What a job shows at its frames, and cameras that a job places.
#include "worker/scene/timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"
#include "worker/scene/view.h"

namespace tilefarm {
namespace {

constexpr double kDegree = glm::pi<double>() / 180;

struct TimelineTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::triangle();
    JobSpec job;

    Timeline open() { return Timeline(job, builder.writeGltf(folder.path()), {}); }
    void move(const char* node) {
        builder.set("/animations/0/samplers/0/input", builder.accessor(std::vector<float>{0, 1}, "SCALAR"));
        builder.set("/animations/0/samplers/0/output",
                    builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {24, 0, 0}}));
        builder.set(
            "/animations/0/channels/0",
            std::string(R"({"sampler": 0, "target": {"path": "translation", "node": )") + node + "}}");
    }
    void addCamera() {
        builder.set("/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})");
        builder.set("/nodes/1", R"({"camera": 0})").set("/scenes/0/nodes/1", 1);
    }
};

TEST_F(TimelineTest, AFrameIsItsNumberOverTheFrameRate) {
    move("0");
    job.motion.fps = 12;
    Timeline timeline = open();
    EXPECT_TRUE(timeline.moves());
    EXPECT_EQ(timeline.steps(), 1u);
    EXPECT_DOUBLE_EQ(timeline.scene(6, 0).instances.at(0).toWorld[3].x, 12);
    EXPECT_DOUBLE_EQ(timeline.scene(-6, 0).instances.at(0).toWorld[3].x, 0);
    EXPECT_DOUBLE_EQ(timeline.scene(600, 0).instances.at(0).toWorld[3].x, 24);
}

TEST_F(TimelineTest, StepsAreTheMiddlesOfPartsOfTheShutter) {
    move("0");
    job.motion.fps = 24;
    job.motion.shutter = 0.5;
    job.motion.shutterSteps = 4;
    Timeline timeline = open();
    EXPECT_EQ(timeline.steps(), 4u);
    for (uint32_t step = 0; step < 4; ++step)
        EXPECT_NEAR(timeline.scene(3, step).instances.at(0).toWorld[3].x, 3 + 0.5 * (step + 0.5) / 4, 1e-9);
}

TEST_F(TimelineTest, ACameraThatMovesAloneLeavesTheSceneAlone) {
    addCamera();
    move("1");
    job.motion.shutter = 1;
    Timeline timeline = open();
    EXPECT_FALSE(timeline.moves());
    EXPECT_EQ(timeline.steps(), 1u);
    const CameraPath path = timeline.camera(4);
    ASSERT_GT(path.keys.size(), 1u);
    EXPECT_NEAR(path.keys.front().toWorld[3].x, 4, 1e-9);
    EXPECT_NEAR(path.keys.back().toWorld[3].x, 5, 1e-9);
    EXPECT_EQ(timeline.camera(100).keys.size(), 1u) << "at the animation's end it stands still";
}

TEST_F(TimelineTest, TheTurntableGoesRoundTheMiddleOfTheScene) {
    job.motion.turntable = 7.5;  // 48 frames a turn
    Timeline timeline = open();
    timeline.release();
    const glm::dvec3 middle(0.5, 0.5, 0);
    const glm::dvec3 first = glm::dvec3(timeline.camera(0).keys.at(0).toWorld[3]) - middle;
    const glm::dvec3 quarter = glm::dvec3(timeline.camera(12).keys.at(0).toWorld[3]) - middle;
    EXPECT_NEAR(quarter.x, first.z, 1e-9) << "+z turns towards +x";
    EXPECT_NEAR(quarter.z, -first.x, 1e-9);
    EXPECT_NEAR(quarter.y, first.y, 1e-12);
    const glm::dmat4 again = timeline.camera(48).keys.at(0).toWorld,
                     start = timeline.camera(0).keys.at(0).toWorld;
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(again[i / 4][i % 4], start[i / 4][i % 4], 1e-9);
}

TEST_F(TimelineTest, WithAnOpenShutterTheTurntablesPathHasThePivotOfItsCircle) {
    job.motion.turntable = 30;
    job.motion.shutter = 0.5;
    const CameraPath path = open().camera(2);
    ASSERT_TRUE(path.pivot);
    const Camera still = path.keys.front();
    EXPECT_NEAR(glm::length(*path.pivot - glm::dvec3(0.5, 0.5, 0)), 0, 1e-12);
    const Camera last = turnedAround(still, *path.pivot, 15);
    EXPECT_NEAR(glm::length(last.toWorld[3] - path.keys.back().toWorld[3]), 0, 1e-9);
}

TEST(View, LooksAtItsTarget) {
    ViewSettings view;
    view.kind = ViewKind::perspective;
    view.eye = {3, 0, 0};
    view.target = {1, 0, 0};
    view.up = {1, 5, 0};  // need not be at a right angle
    view.yfov = 60;
    const Camera camera = placedCamera(view);
    EXPECT_NEAR(glm::length(glm::dvec3(camera.toWorld[2]) - glm::dvec3(1, 0, 0)), 0, 1e-12);
    EXPECT_NEAR(glm::length(glm::dvec3(camera.toWorld[1]) - glm::dvec3(0, 1, 0)), 0, 1e-12);
    EXPECT_NEAR(glm::determinant(camera.toWorld), 1, 1e-12);
    EXPECT_NEAR(camera.yfov, 60 * kDegree, 1e-6);
    view.up = {-1, 0, 0};  // along the view
    EXPECT_NEAR(glm::determinant(placedCamera(view).toWorld), 1, 1e-12) << "some direction is up then";
}

TEST(View, AnApertureByFNumberIsTheFocalLengthsShare) {
    ViewSettings view;
    view.kind = ViewKind::perspective;
    view.eye = {0, 0, 5};
    view.yfov = 2 * std::atan(0.5) / kDegree;
    view.fNumber = 2;
    view.sensorWidth = 0.036;
    Camera camera = placedCamera(view);
    setLens(camera, view, 1.5, {});
    // tan(xfov / 2) = 0.75: a focal length of 24 mm, an aperture of 12 mm.
    EXPECT_NEAR(camera.apertureRadius, 0.006, 1e-8);
    EXPECT_FLOAT_EQ(camera.focusDistance, 5) << "on its target";
    view.focusDistance = 2.5;
    setLens(camera, view, 1.5, {});
    EXPECT_FLOAT_EQ(camera.focusDistance, 2.5f);
    Camera flat;
    flat.orthographic = true;
    setLens(flat, view, 1.5, {});
    EXPECT_EQ(flat.apertureRadius, 0);
}

}  // namespace
}  // namespace tilefarm
