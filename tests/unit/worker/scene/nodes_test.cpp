#include "worker/scene/nodes.h"

#include <gmock/gmock.h>

#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_source.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

struct NodesTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::triangle();
    Scene load() { return loadGltf(builder.writeGltf(folder.path())); }
    std::string fault() {
        return errorOf([&] { load(); }).what();
    }
};

void expectNear(const glm::dmat4& a, const glm::dmat4& b, double tolerance) {
    for (int i = 0; i < 16; ++i) {
        EXPECT_NEAR(a[i / 4][i % 4], b[i / 4][i % 4], tolerance) << "column " << i / 4 << ", row " << i % 4;
    }
}

TEST_F(NodesTest, ComposesTranslationRotationAndScale) {
    // 90 degrees about y takes +x to -z.
    builder.set("/nodes/0", R"({"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0.7071067811865476, 0,
                                 0.7071067811865476], "scale": [2, 3, 4]})");
    const glm::dmat4 m = load().instances.at(0).toWorld;
    expectNear(m, glm::dmat4(0, 0, -2, 0, 0, 3, 0, 0, 4, 0, 0, 0, 1, 2, 3, 1), 1e-15);
}

TEST_F(NodesTest, ReadsMatricesByColumns) {
    builder.set("/nodes/0", R"({"mesh": 0, "matrix": [1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1]})");
    const glm::dmat4 m = load().instances.at(0).toWorld;
    EXPECT_EQ(m[3], glm::dvec4(11, 12, 13, 1));
    EXPECT_EQ(m[0], glm::dvec4(1, 2, 3, 0));
}

TEST_F(NodesTest, ComposesLongChainsInDouble) {
    // HARD-CASES 15: fifty rotations and scales against the same product in closed form.
    const double angle = 0.1, scale = 1.01;
    builder.set("/nodes", "[]");
    for (int i = 0; i < 50; ++i) {
        builder.set(
            fmt::format("/nodes/{}", i),
            fmt::format(R"({{"rotation": [0, 0, {:.17g}, {:.17g}], "scale": [{:.17g}, {:.17g}, {:.17g}]}})",
                        std::sin(angle / 2), std::cos(angle / 2), scale, scale, scale));
        if (i < 49) {
            builder.set(fmt::format("/nodes/{}/children", i), fmt::format("[{}]", i + 1));
        }
    }
    builder.set("/nodes/49/mesh", 0);
    const glm::dmat4 expected =
        glm::scale(glm::rotate(glm::dmat4(1), 50 * angle, {0, 0, 1}), glm::dvec3(std::pow(scale, 50)));
    expectNear(load().instances.at(0).toWorld, expected, 1e-13);
}

TEST_F(NodesTest, RefusesCyclesAndSecondParents) {
    builder.set("/nodes/1/children", "[2]").set("/nodes/2/children", "[1]");
    EXPECT_THAT(fault(), HasSubstr("/nodes/1: is its own ancestor"));
    builder.set("/nodes/2/children", "[]").set("/nodes/3/children", "[2]");
    EXPECT_THAT(fault(), HasSubstr("/nodes/3/children/0: /nodes/2 is a child of /nodes/1 already"));
    builder.set("/nodes/3/children", "[3]");
    EXPECT_THAT(fault(), HasSubstr("/nodes/3: is its own ancestor"));
    builder.set("/nodes/3/children", "[17]");
    EXPECT_THAT(fault(), HasSubstr("/nodes/3/children/0: refers to /nodes/17"));
}

TEST_F(NodesTest, RefusesTransformsThatAreNone) {
    struct Case {
        const char *node, *fault;
    };
    for (const Case& c :
         {Case{R"({"matrix": [1, 2]})", "/nodes/0/matrix: must have 16 numbers"},
          Case{R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0.5, 0,0,0,1]})", "/nodes/0/matrix: is not an affine"},
          Case{R"({"rotation": [0, 0, 0, 0]})", "/nodes/0/rotation: is not a unit quaternion"},
          Case{R"({"scale": [1, 1, "x"]})", "/nodes/0/scale/2: must be a number, is string"},
          Case{R"({"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale": [1, 1, 1]})", "has both"}}) {
        builder.set("/nodes/0", c.node);
        EXPECT_THAT(fault(), HasSubstr(c.fault));
    }
    builder.set("/nodes/0", R"({"mesh": 0, "scale": [1e300, 1, 1]})");
    builder.set("/nodes/1", R"({"children": [0], "scale": [1e300, 1, 1]})");
    EXPECT_THAT(fault(), HasSubstr("/nodes/0: its transform, with those of its parents, is not finite"));
}

TEST_F(NodesTest, PicksTheDefaultSceneElseTheFirstElseAllRoots) {
    builder.set("/nodes",
                R"([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}, {"mesh": 0, "name": "c"}])");
    builder.set("/scenes", R"([{"nodes": [0]}, {"nodes": [2, 1]}])").set("/scene", 1);
    Scene scene = load();
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].node, "c");
    builder.erase("/scene");
    scene = load();
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].node, "a");
    builder.erase("/scenes");
    EXPECT_EQ(load().instances.size(), 3u);
    builder.set("/scene", 0);
    EXPECT_THAT(fault(), HasSubstr("/scene: refers to /scenes/0"));
}

TEST_F(NodesTest, LeavesOutInvisibleSubtrees) {
    builder.set("/nodes/1",
                R"({"children": [0], "extensions": {"KHR_node_visibility": {"visible": false}}})");
    builder.set("/scenes/0/nodes", "[1]");
    EXPECT_TRUE(load().instances.empty());
}

TEST_F(NodesTest, PlacesCamerasWithoutTheirScale) {
    builder.set("/cameras",
                R"([{"type": "perspective", "name": "Lens", "perspective": {"yfov": 0.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 9}}])");
    builder.set("/nodes/1",
                R"({"camera": 0, "scale": [2, 2, 2], "translation": [0, 0, 5], "name": "Stand"})");
    builder.set("/nodes/2", R"({"camera": 1})").set("/scenes/0/nodes", "[0, 1, 2]");
    const Scene scene = load();
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].yfov, 0.5f);
    EXPECT_EQ(scene.cameras[0].aspect, 0);
    EXPECT_EQ(scene.cameras[0].name, "Lens");
    EXPECT_EQ(scene.cameras[0].node, "Stand");
    expectNear(scene.cameras[0].toWorld, glm::translate(glm::dmat4(1), {0, 0, 5}), 0);
    EXPECT_TRUE(scene.cameras[1].orthographic);
    EXPECT_EQ(scene.cameras[1].xmag, 3);
    EXPECT_EQ(scene.cameras[1].ymag, 2);
    EXPECT_EQ(scene.cameras[1].name, "nodes/2");
}

TEST_F(NodesTest, RefusesCamerasThatSeeNothing) {
    builder.set("/nodes/1/camera", 0).set("/scenes/0/nodes", "[0, 1]");
    for (const char* camera :
         {R"({"type": "perspective", "perspective": {"yfov": 0}})",
          R"({"type": "perspective", "perspective": {"yfov": 3.2}})", R"({"type": "perspective"})",
          R"({"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1}})", R"({"type": "fisheye"})"}) {
        builder.set("/cameras/0", camera);
        EXPECT_THAT(fault(), HasSubstr("/cameras/0/")) << camera;
    }
}

TEST_F(NodesTest, PlacesLights) {
    builder.set("/extensions/KHR_lights_punctual/lights", R"([
        {"type": "spot", "color": [1, 0.5, 0], "intensity": 10, "range": 7, "spot": {"outerConeAngle": 0.6}},
        {"type": "directional", "name": "Sun"}, {"type": "point", "intensity": 2}])");
    // 90 degrees about x takes -z to +y.
    builder.set("/nodes/1",
                R"({"translation": [1, 2, 3], "scale": [9, 9, 9], "rotation": [0.7071067811865476, 0, 0,
        0.7071067811865476], "extensions": {"KHR_lights_punctual": {"light": 0}}})");
    builder.set("/nodes/2", R"({"extensions": {"KHR_lights_punctual": {"light": 1}}})");
    builder.set("/scenes/0/nodes", "[0, 1, 2]");
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 2u);
    const PunctualLight& spot = scene.lights[0];
    EXPECT_EQ(spot.type, PunctualType::spot);
    EXPECT_EQ(spot.color, glm::vec3(10, 5, 0));
    EXPECT_EQ(spot.position, glm::dvec3(1, 2, 3));
    EXPECT_NEAR(spot.direction.y, 1, 1e-6);
    EXPECT_EQ(spot.range, 7);
    EXPECT_EQ(spot.innerCone, 0);
    EXPECT_FLOAT_EQ(spot.outerCone, 0.6f);
    EXPECT_EQ(scene.lights[1].type, PunctualType::directional);
    EXPECT_EQ(scene.lights[1].direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(scene.lights[1].name, "Sun");
    builder.set("/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", "0.7");
    EXPECT_THAT(fault(), HasSubstr("/extensions/KHR_lights_punctual/lights/0/spot: its cones"));
}

TEST_F(NodesTest, DividesLightsInLumensByWhatAWattHas) {
    builder.set("/extensionsUsed", R"(["KHR_lights_punctual", "TILEFARM_lights"])");
    builder.set("/extensions/KHR_lights_punctual/lights", R"([
        {"type": "point", "intensity": 683, "color": [1, 0.5, 0]}, {"type": "directional", "intensity": 1366},
        {"type": "point", "intensity": 683, "extensions": {"TILEFARM_lights": {"width": 2, "height": 0.5}}}])");
    for (uint32_t i = 0; i < 3; ++i) {
        builder.set(fmt::format("/nodes/{}/extensions/KHR_lights_punctual/light", i + 1), i);
        builder.set(fmt::format("/scenes/0/nodes/{}", i + 1), i + 1);
    }
    GltfOptions options;
    options.lightUnits = LightUnits::photometric;
    const Scene scene = GltfSource(builder.writeGltf(folder.path()), options).take();
    ASSERT_EQ(scene.lights.size(), 2u);
    ASSERT_EQ(scene.areaLights.size(), 1u);
    EXPECT_NEAR(scene.lights[0].color.x, 1, 1e-6);
    EXPECT_NEAR(scene.lights[0].color.y, 0.5, 1e-6);
    EXPECT_NEAR(scene.lights[1].color.x, 2, 1e-6);
    EXPECT_NEAR(scene.areaLights[0].radiance.x, 1, 1e-6) << "as strong as the light that it was";
    EXPECT_EQ(load().lights[0].color.x, 683);
}

TEST_F(NodesTest, ReadsTheClippingPlanesOfCameras) {
    builder.set("/cameras", R"([
        {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.25}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 8}},
        {"type": "perspective", "perspective": {"yfov": 1, "znear": 5, "zfar": 5}}])");
    for (uint32_t i = 0; i < 3; ++i) {
        builder.set(fmt::format("/nodes/{}/camera", i + 1), i);
        builder.set(fmt::format("/scenes/0/nodes/{}", i + 1), i + 1);
    }
    const Scene scene = load();
    ASSERT_EQ(scene.cameras.size(), 3u);
    EXPECT_EQ(scene.cameras[0].znear, 0.25f);
    EXPECT_TRUE(std::isinf(scene.cameras[0].zfar));
    EXPECT_EQ(scene.cameras[1].znear, 0);
    EXPECT_EQ(scene.cameras[1].zfar, 8);
    EXPECT_TRUE(std::isinf(scene.cameras[2].zfar)) << "planes that leave nothing are none";
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "zfar");
}

TEST_F(NodesTest, InstancesAMeshOnTheGpusBehalf) {
    const std::string attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/";
    builder.set("/nodes/0/translation", "[0, 0, 10]");
    builder.set(attributes + "TRANSLATION", builder.accessor(std::vector<glm::vec3>{{1, 0, 0}, {2, 0, 0}}));
    builder.set(attributes + "ROTATION",
                builder.accessor(std::vector<int8_t>{0, 0, 0, 127, 0, 90, 0, 90}, "VEC4", true));
    builder.set(attributes + "SCALE", builder.accessor(std::vector<glm::vec3>{{1, 1, 1}, {3, 3, 3}}));
    const Scene scene = load();
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].toWorld[3], glm::dvec4(1, 0, 10, 1));
    expectNear(scene.instances[1].toWorld, glm::dmat4(0, 0, -3, 0, 0, 3, 0, 0, 3, 0, 0, 0, 2, 0, 10, 1),
               1e-12);
    builder.set(attributes + "SCALE", builder.accessor(std::vector<glm::vec3>{{1, 1, 1}}));
    EXPECT_THAT(fault(), HasSubstr("EXT_mesh_gpu_instancing/attributes/SCALE: has 1 elements"));
}

TEST_F(NodesTest, WarnsOfASkinWithoutInfluences) {
    builder.set("/nodes/0/skin", 0).set("/nodes/0/name", R"("Arm")").set("/skins/0/joints", "[0]");
    const Scene scene = load();
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].where, "nodes/0 (Arm)");
    EXPECT_EQ(scene.warnings[0].feature, "skins");
}

}  // namespace
}  // namespace tilefarm
