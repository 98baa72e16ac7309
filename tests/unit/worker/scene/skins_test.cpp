// Skinning against its definition, and that the skinned cylinder of Khronos bends.
#include "worker/scene/skins.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_source.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

struct SkinsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();

    /// Joints at nodes 1 and 2, moved as given; every vertex follows both by half, unless said otherwise.
    void skin(const std::string& first, const std::string& second, glm::vec4 weights = {0.5f, 0.5f, 0, 0},
              std::vector<uint8_t> joints = {}) {
        const bool halves = joints.empty();
        builder.set("/nodes/1", first).set("/nodes/2", second);
        builder.set("/scenes/0/nodes", "[0, 1, 2]");
        builder.set("/skins/0/joints", "[1, 2]").set("/nodes/0/skin", 0);
        for (uint8_t i = 0; joints.size() < 16 && i < 16 && halves; ++i) {
            joints.push_back(i % 4 == 1);
        }
        const std::string attributes = "/meshes/0/primitives/0/attributes";
        builder.set(attributes + "/JOINTS_0", builder.accessor(joints, "VEC4"));
        builder.set(attributes + "/WEIGHTS_0", builder.accessor(std::vector<glm::vec4>(4, weights)));
    }
    WorldGeometry world() { return flatten(GltfSource(builder.writeGltf(folder.path()), {}).take()); }
    std::string fault() {
        return errorOf([&] { world(); }).what();
    }
};

/// Where corner (x, y) of the square went, and that the rest of the world agrees.
glm::dvec3 cornerAt(const WorldGeometry& world, size_t i) {
    return glm::dvec3(world.positions.at(i)) + world.centre;
}

TEST_F(SkinsTest, VerticesFollowTheWeightedMeanOfTheirJointsWhereverTheirNodeIs) {
    skin(R"({"translation": [4, 0, 0]})", R"({"translation": [0, 2, 6]})");
    builder.set("/nodes/0/translation", "[100, 100, 100]");
    const WorldGeometry w = world();
    ASSERT_EQ(w.positions.size(), 4u);
    glm::dvec3 lower(1e9);
    for (size_t i = 0; i < 4; ++i) {
        lower = glm::min(lower, cornerAt(w, i));
    }
    EXPECT_EQ(lower, glm::dvec3(2, 1, 3));
}

TEST_F(SkinsTest, InverseBindMatricesUndoTheBindPose) {
    skin(R"({"translation": [4, 0, 0]})", R"({"translation": [0, 2, 6]})");
    const std::vector<glm::mat4> inverse{glm::translate(glm::mat4(1), glm::vec3(-4, 0, 0)),
                                         glm::translate(glm::mat4(1), glm::vec3(0, -2, -6))};
    builder.set("/skins/0/inverseBindMatrices",
                builder.accessorOf(builder.view(std::as_bytes(std::span(inverse))), "MAT4", 5126, 2));
    const WorldGeometry w = world();
    EXPECT_EQ(glm::dvec3(w.lower) + w.centre, glm::dvec3(0)) << "in the pose that it was bound in";
    EXPECT_EQ(glm::dvec3(w.upper) + w.centre, glm::dvec3(1, 1, 0));
}

TEST_F(SkinsTest, NormalsGoByTheInverseTranspose) {
    // A shear-like scale: the square tilted by 45° about x, then squeezed in z by 1/4 by a parent.
    const double s = std::sin(0.39269908169872414), c = std::cos(0.39269908169872414);
    builder.set("/nodes/3", R"({"scale": [1, 1, 0.25], "children": [1, 2]})");
    const std::string turned = fmt::format(R"({{"rotation": [{}, 0, 0, {}]}})", s, c);
    skin(turned, turned);
    builder.set("/scenes/0/nodes", "[0, 3]");
    const WorldGeometry w = world();
    const glm::uvec3 t = w.triangles[0];
    const glm::vec3 geometric =
        glm::normalize(glm::cross(w.positions[t.y] - w.positions[t.x], w.positions[t.z] - w.positions[t.x]));
    EXPECT_NEAR(glm::distance(geometric, w.normals[t.x]), 0, 1e-6);
    EXPECT_NEAR(glm::distance(geometric, glm::normalize(glm::vec3(0, -1, 4))), 0, 1e-6);
}

TEST_F(SkinsTest, MirroringJointsKeepTheFrontInFront) {
    skin(R"({"scale": [-1, 1, 1]})", R"({"scale": [-1, 1, 1]})");
    const WorldGeometry w = world();
    for (const glm::uvec3& t : w.triangles) {
        EXPECT_GT(glm::cross(w.positions[t.y] - w.positions[t.x], w.positions[t.z] - w.positions[t.x]).z, 0);
    }
}

TEST_F(SkinsTest, ASecondSetAddsFourMoreJointsAndWeightsAreScaledToOne) {
    skin(R"({"translation": [4, 0, 0]})", R"({"translation": [0, 8, 0]})", {0.5f, 0, 0, 0});
    const std::string attributes = "/meshes/0/primitives/0/attributes";
    std::vector<uint16_t> joints(16, 1);
    builder.set(attributes + "/JOINTS_1", builder.accessor(joints, "VEC4"));
    builder.set(attributes + "/WEIGHTS_1", builder.accessor(std::vector<glm::vec4>(4, {1, 0.5f, 0, 0})));
    const WorldGeometry w = world();
    EXPECT_EQ(glm::dvec3(w.lower) + w.centre, glm::dvec3(1, 6, 0)) << "a quarter and three quarters";
}

TEST_F(SkinsTest, KeepsItsPrecisionFarFromTheOrigin) {
    skin(R"({"translation": [1e7, 0, 0]})", R"({"translation": [1e7, 0, 0]})");
    const WorldGeometry w = world();
    EXPECT_EQ(w.upper - w.lower, glm::vec3(1, 1, 0));
}

TEST_F(SkinsTest, AVertexWithoutWeightsFollowsTheFirstJointThatItNames) {
    skin(R"({"translation": [4, 0, 0]})", R"({"translation": [0, 8, 0]})", glm::vec4(0),
         std::vector<uint8_t>(16, 1));
    Scene scene = GltfSource(builder.writeGltf(folder.path()), {}).take();
    const WorldGeometry w = flatten(scene);
    EXPECT_EQ(glm::dvec3(w.lower) + w.centre, glm::dvec3(0, 8, 0));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].where, "meshes/0/primitives/0/attributes/WEIGHTS_0");
}

TEST_F(SkinsTest, AWeightThatIsNegativeByRoundingIsZero) {
    skin(R"({"translation": [4, 0, 0]})", R"({"translation": [0, 8, 0]})", {1, -1e-7f, 0, 0});
    builder.set(
        "/meshes/0/primitives/0/attributes/JOINTS_0",
        builder.accessor(std::vector<uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4"));
    const auto path = builder.writeGltf(folder.path());
    const WorldGeometry w = flatten(GltfSource(path, {}).take());
    EXPECT_EQ(glm::dvec3(w.lower) + w.centre, glm::dvec3(4, 0, 0));
    EXPECT_THAT(errorOf([&] { GltfSource(path, {.strict = true}).take(); }).what(), HasSubstr("/WEIGHTS_0:"));
}

TEST_F(SkinsTest, TheSharedCaseWithoutWeightsFollowsJointOne) {
    const std::filesystem::path shared =
        std::filesystem::path(TILEFARM_SHARED_DATA) / "cases/skin-zero-weights-joint1";
    if (!std::filesystem::exists(shared)) GTEST_SKIP() << "no shared data";
    const WorldGeometry a = flatten(GltfSource(shared / "a.gltf", {}).take());
    const WorldGeometry b = flatten(GltfSource(shared / "b.gltf", {}).take());
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(double{a.lower[c]} + a.centre[c], double{b.lower[c]} + b.centre[c], 1e-6);
        EXPECT_NEAR(double{a.upper[c]} + a.centre[c], double{b.upper[c]} + b.centre[c], 1e-6);
    }
}

TEST_F(SkinsTest, FaultsAreNamedWithTheirPlace) {
    const std::string still = "{}", attributes = "/meshes/0/primitives/0/attributes";
    const auto expectFault = [&](auto change, const std::string& place, const std::string& words) {
        builder = GltfBuilder::square();
        change();
        const std::string text = fault();
        EXPECT_THAT(text, HasSubstr(place));
        EXPECT_THAT(text, HasSubstr(words));
    };
    expectFault(
        [&] {
            skin(still, still, {1, 0, 0, 0}, std::vector<uint8_t>(16, 2));
        },
        attributes + "/JOINTS_0:", "joint 2 of a skin of 2");
    expectFault(
        [&] {
            skin(still, still, {std::nanf(""), 0, 0, 0});
        },
        attributes + "/WEIGHTS_0:", "vertex 0");
    expectFault([&] { skin(still, still, {-1, 2, 0, 0}); }, attributes + "/WEIGHTS_0:", "-1");
    expectFault(
        [&] {
            skin(still, still, {1, 0, 0, 0}, std::vector<uint8_t>(12, 0));
        },
        attributes + "/JOINTS_0:", "has 3 elements");
    expectFault(
        [&] {
            skin(still, still);
            builder.erase(attributes + "/WEIGHTS_0");
        },
        attributes, "WEIGHTS_0 has 0 elements");
    expectFault(
        [&] {
            skin(still, still);
            builder.set("/skins/0/joints", "[1, 7]");
        },
        "/skins/0/joints/1:", "/nodes/7");
    expectFault(
        [&] {
            skin(still, still);
            builder.set("/skins/0/joints", "[]");
        },
        "/skins/0/joints:", "no joint");
    expectFault(
        [&] {
            skin(still, still);
            const std::vector<glm::mat4> one(1);
            builder.set("/skins/0/inverseBindMatrices",
                        builder.accessorOf(builder.view(std::as_bytes(std::span(one))), "MAT4", 5126, 1));
        },
        "/skins/0/inverseBindMatrices:", "1 matrices for 2 joints");
    expectFault(
        [&] {
            skin(still, still);
            builder.set("/nodes/0/skin", 3);
        },
        "/nodes/0/skin:", "/skins/3");
}

TEST(SkinnedCylinder, BendsAsItsAnimationSays) {
    const std::filesystem::path file = std::filesystem::path(TILEFARM_SHARED_DATA) /
                                       "scenes/khronos-03_skinned_cylinder/03_skinned_cylinder.gltf";
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "no shared data";
    }
    GltfSource source(file, {});
    ASSERT_GT(source.seconds(), 0);
    const auto boundsAt = [&](double seconds) {
        const WorldGeometry w = flatten(source.at(seconds));
        EXPECT_EQ(w.triangleCount(), 316u);
        return std::pair(glm::dvec3(w.lower) + w.centre, glm::dvec3(w.upper) + w.centre);
    };
    // Four joints a unit apart: bent, the cylinder's top moves aside and sinks.
    const auto [restLower, restUpper] = boundsAt(0);
    double lowest = restUpper.y, widest = 0;
    for (int i = 0; i <= 8; ++i) {
        const auto [lower, upper] = boundsAt(source.seconds() * i / 8);
        lowest = std::min(lowest, upper.y);
        widest = std::max(widest, glm::length(upper - lower));
    }
    EXPECT_GT(restUpper.y - lowest, 0.1);
    EXPECT_LT(widest, 2 * glm::length(restUpper - restLower)) << "it bends, it does not explode";
}

}  // namespace
}  // namespace tilefarm
