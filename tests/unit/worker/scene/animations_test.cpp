// Animations against closed forms, and what a bad file is told.
#include "worker/scene/animations.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_source.h"

namespace tilefarm {
namespace {

using std::numbers::pi;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Keyframes keysOf(std::vector<float> times, std::vector<float> values, uint32_t width, Interpolation how) {
    return {std::move(times), std::move(values), width, how, false};
}

TEST(Keyframes, LinearIsExactBetweenKeysAndConstantOutside) {
    const Keyframes keys = keysOf({1, 3}, {0, 10, 4, 20}, 2, Interpolation::linear);
    EXPECT_THAT(keys.at(-5), ElementsAre(0, 10));
    EXPECT_THAT(keys.at(1.5), ElementsAre(1, 12.5));
    EXPECT_THAT(keys.at(3), ElementsAre(4, 20));
    EXPECT_THAT(keys.at(99), ElementsAre(4, 20));
}

TEST(Keyframes, StepHoldsUntilTheNextKey) {
    const Keyframes keys = keysOf({0, 1, 2}, {5, 6, 7}, 1, Interpolation::step);
    EXPECT_THAT(keys.at(0.999), ElementsAre(5));
    EXPECT_THAT(keys.at(1), ElementsAre(6));
    EXPECT_THAT(keys.at(2), ElementsAre(7));
}

TEST(Keyframes, CubicFollowsACubicPolynomialExactly) {
    // p(t) = t³ - 2t + 1 with its derivative 3t² - 2 as tangents; keys 2 s apart show the scaling by time.
    const auto p = [](double t) { return t * t * t - 2 * t + 1; };
    const auto slope = [](double t) { return 3 * t * t - 2; };
    Keyframes keys = keysOf({0, 2, 3}, {}, 1, Interpolation::cubic);
    for (const float t : keys.times) {
        for (const double v : {slope(t), p(t), slope(t)}) {
            keys.values.push_back(float(v));
        }
    }
    for (double t = 0; t <= 3; t += 0.125) {
        EXPECT_NEAR(keys.at(t)[0], p(t), 1e-12) << t;
    }
}

TEST(Keyframes, RotationsTurnEvenlyTheShorterWay) {
    Keyframes keys = keysOf({0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}, 4, Interpolation::linear);
    keys.rotation = true;
    // A quarter turn about y, written with the other sign, which is the same rotation.
    keys.values[5] = -float(std::sin(pi / 4));
    keys.values[7] = -float(std::cos(pi / 4));
    for (double t = 0; t <= 1; t += 0.1) {
        const double half = pi / 4 * t;
        EXPECT_THAT(keys.at(t),
                    Pointwise(DoubleNear(1e-7), std::vector<double>{0, std::sin(half), 0, std::cos(half)}));
    }
}

struct AnimationsTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::triangle();

    /// A channel with a sampler of its own, in animation `a`.
    void animate(const std::string& target, std::vector<float> times, std::vector<float> values,
                 const char* type = "VEC3", const char* how = "LINEAR", size_t a = 0) {
        const std::string animation = fmt::format("/animations/{}", a);
        const size_t n = builder.size(animation + "/samplers");
        builder.set(fmt::format("{}/samplers/{}", animation, n),
                    fmt::format(R"({{"input": {}, "output": {}, "interpolation": "{}"}})",
                                builder.accessor(times, "SCALAR"), builder.accessor(values, type), how));
        builder.set(fmt::format("{}/channels/{}", animation, n),
                    fmt::format(R"({{"sampler": {}, "target": {}}})", n, target));
    }
    static std::string node(const std::string& path) { return R"({"node": 0, "path": ")" + path + R"("})"; }
    static std::string pointer(const std::string& to) {
        return R"({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": ")" + to +
               R"("}}})";
    }
    GltfSource open(const GltfOptions& options = {}) {
        return GltfSource(builder.writeGltf(folder.path()), options);
    }
    std::string fault() {
        return errorOf([&] { open().at(0); }).what();
    }
};

TEST_F(AnimationsTest, NodesMoveTurnAndGrow) {
    const float s = float(std::sqrt(0.5));
    animate(node("translation"), {0, 1}, {0, 0, 0, 2, 4, 6});
    animate(node("rotation"), {0, 1}, {0, 0, 0, 1, 0, s, 0, s}, "VEC4");
    animate(node("scale"), {0, 1}, {1, 1, 1, 3, 3, 3});
    GltfSource source = open();
    EXPECT_TRUE(source.animated());
    EXPECT_EQ(source.seconds(), 1);
    const glm::dmat4 m = source.at(0.5).instances.at(0).toWorld;
    EXPECT_EQ(glm::dvec3(m[3]), glm::dvec3(1, 2, 3));
    const double c = std::cos(pi / 4);  // half of the quarter turn, at scale 2; +x turns towards -z
    EXPECT_NEAR(m[0].x, 2 * c, 1e-7);
    EXPECT_NEAR(m[0].z, -2 * c, 1e-7);
    EXPECT_EQ(glm::dvec3(source.at(7).instances.at(0).toWorld[3]), glm::dvec3(2, 4, 6)) << "stays at the end";
    EXPECT_EQ(glm::dvec3(source.at(0.5).instances.at(0).toWorld[3]), glm::dvec3(1, 2, 3))
        << "time may go back";
}

TEST_F(AnimationsTest, LoopsStartAgainEachAtItsOwnLength) {
    builder.set("/nodes/1", R"({"mesh": 0})").set("/scenes/0/nodes/1", 1);
    animate(node("translation"), {0, 2}, {0, 0, 0, 2, 0, 0});
    animate(R"({"node": 1, "path": "translation"})", {0, 3}, {0, 0, 0, 3, 0, 0}, "VEC3", "LINEAR", 1);
    GltfSource source = open({"", "all", true});
    const Scene& scene = source.at(3.5);
    EXPECT_DOUBLE_EQ(scene.instances[0].toWorld[3].x, 1.5);
    EXPECT_DOUBLE_EQ(scene.instances[1].toWorld[3].x, 0.5);
}

TEST_F(AnimationsTest, OneMayBeChosenByNameOrNone) {
    animate(node("translation"), {0, 1}, {0, 0, 0, 1, 0, 0});
    animate(node("translation"), {0, 1}, {0, 0, 0, 0, 1, 0}, "VEC3", "LINEAR", 1);
    builder.set("/animations/0/name", R"("Walk")").set("/animations/1/name", R"("Jump")");
    EXPECT_EQ(glm::dvec3(open({"", "Walk", false}).at(1).instances[0].toWorld[3]), glm::dvec3(1, 0, 0));
    EXPECT_EQ(glm::dvec3(open({"", "Jump", false}).at(1).instances[0].toWorld[3]), glm::dvec3(0, 1, 0));
    EXPECT_FALSE(open({"", "none", false}).animated());
    GltfSource all = open();
    const Scene& scene = all.at(1);
    EXPECT_EQ(glm::dvec3(scene.instances[0].toWorld[3]), glm::dvec3(0, 1, 0)) << "the later one holds";
    EXPECT_EQ(scene.warnings.at(0).feature, "animations");
    const std::string fault = errorOf([&] { open({"", "Swim", false}); }).what();
    EXPECT_THAT(fault, HasSubstr("\"Walk\", \"Jump\""));
}

TEST_F(AnimationsTest, PointersMoveMaterialsLightsCamerasAndVisibility) {
    builder.set("/materials/0",
                R"({"pbrMetallicRoughness": {"metallicFactor": 1}, "emissiveFactor": [0, 0, 0]})");
    builder.set("/meshes/0/primitives/0/material", 0);
    builder.set("/extensions/KHR_lights_punctual/lights/0", R"({"type": "point"})");
    builder.set("/nodes/0/extensions/KHR_lights_punctual/light", 0);
    builder.set("/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})");
    builder.set("/nodes/0/camera", 0);
    builder.set("/nodes/1", R"({"mesh": 0})").set("/scenes/0/nodes/1", 1);
    animate(pointer("/materials/0/pbrMetallicRoughness/baseColorFactor"), {0, 1},
            {0, 0, 0, 1, 1, 0.5f, 0.25f, 1}, "VEC4");
    animate(pointer("/materials/0/emissiveFactor"), {0, 1}, {0, 0, 0, 1, 1, 1});
    animate(pointer("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"), {0, 1},
            {0, 8}, "SCALAR");
    animate(pointer("/extensions/KHR_lights_punctual/lights/0/intensity"), {0, 1}, {0, 10}, "SCALAR");
    animate(pointer("/cameras/0/perspective/yfov"), {0, 1}, {1, 0.5f}, "SCALAR");
    animate(pointer("/nodes/1/extensions/KHR_node_visibility/visible"), {0, 0.5f}, {1, 0}, "SCALAR", "STEP");
    GltfSource source = open();
    EXPECT_EQ(source.at(0).instances.size(), 2u);
    const Scene& scene = source.at(0.5);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.materials[0].baseColor, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(scene.materials[0].emission, glm::vec3(0.5f * 4));
    EXPECT_EQ(scene.lights.at(0).color, glm::vec3(5));
    EXPECT_FLOAT_EQ(scene.cameras.at(0).yfov, 0.75f);
    EXPECT_EQ(scene.instances.size(), 1u) << "the second node is hidden";
}

TEST_F(AnimationsTest, PropertiesThatAreNotRenderedAreWarnings) {
    animate(pointer("/materials/0/extensions/ACME_glow/amount"), {0, 1}, {0, 1}, "SCALAR");
    GltfSource source = open();
    const Scene& scene = source.at(0);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0].feature, HasSubstr("ACME_glow/amount"));
    EXPECT_EQ(scene.warnings[0].where, "animations/0/channels/0");
    EXPECT_FALSE(source.animated());
}

TEST_F(AnimationsTest, MorphWeightsMoveVertices) {
    const auto target = [&](glm::vec3 delta) { return builder.accessor(std::vector<glm::vec3>(3, delta)); };
    builder.set("/meshes/0/primitives/0/targets/0/POSITION", target({0, 0, 2}));
    builder.set("/meshes/0/primitives/0/targets/1/POSITION", target({4, 0, 0}));
    animate(node("weights"), {0, 1}, {0, 0, 1, 0.5f}, "SCALAR");
    builder.set("/nodes/1", R"({"mesh": 0})").set("/scenes/0/nodes/1", 1);  // at its default weights of 0
    GltfSource source = open();
    const Scene& scene = source.at(0.5);
    EXPECT_EQ(scene.meshes[scene.instances[0].mesh].positions[0], glm::vec3(1, 0, 1));
    EXPECT_EQ(scene.meshes[scene.instances[1].mesh].positions[0], glm::vec3(0));
    const size_t meshes = scene.meshes.size();
    for (const double t : {0.1, 0.7, 0.3, 1.0}) {
        EXPECT_EQ(source.at(t).meshes.size(), meshes) << "places are used again";
    }
    EXPECT_EQ(scene.meshes[scene.instances[0].mesh].positions[0], glm::vec3(2, 0, 2));
}

TEST_F(AnimationsTest, MorphTargetsMoveNormalsAndTangentsAndMayBeSparse) {
    builder = GltfBuilder::square();
    const std::string primitive = "/meshes/0/primitives/0";
    builder.set("/materials/0", R"({"normalTexture": {"index": 0}})").set(primitive + "/material", 0);
    builder.set("/textures/0", R"({"source": 0})");
    builder.set("/images/0", fmt::format(R"({{"uri": "data:image/png;base64,{}"}})",
                                         base64(encodePng(1, 1, 3, 8, {128, 128, 255}))));
    builder.set(primitive + "/attributes/TANGENT", builder.accessor(std::vector<glm::vec4>(4, {1, 0, 0, 1})));
    builder.set(primitive + "/targets/0/NORMAL", builder.accessor(std::vector<glm::vec3>(4, {0, 1, 0})));
    builder.set(primitive + "/targets/0/TANGENT", builder.accessor(std::vector<glm::vec3>(4, {-1, 1, -1})));
    // A sparse accessor without a buffer view: only vertex 2 moves.
    const std::vector<uint16_t> one{2};
    const std::vector<glm::vec3> delta{{0, 0, 3}};
    const uint32_t indices = builder.view(std::as_bytes(std::span(one)));
    const uint32_t values = builder.view(std::as_bytes(std::span(delta)));
    const size_t sparse = builder.size("/accessors");
    builder.set(fmt::format("/accessors/{}", sparse),
                fmt::format(R"({{"componentType": 5126, "type": "VEC3", "count": 4, "sparse": {{"count": 1,
                    "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}}}})",
                            indices, values));
    builder.set(primitive + "/targets/0/POSITION", uint32_t(sparse));
    builder.set("/meshes/0/weights", "[1]");
    GltfSource source = open();
    const Mesh& mesh = source.at(0).meshes.at(0);
    size_t moved = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        moved += mesh.positions[i].z == 3;
        EXPECT_NEAR(glm::distance(mesh.normals[i], glm::normalize(glm::vec3(0, 1, 1))), 0, 1e-6);
        EXPECT_NEAR(glm::distance(glm::vec3(mesh.tangents[i]), glm::normalize(glm::vec3(0, 1, -1))), 0, 1e-6);
        EXPECT_EQ(mesh.tangents[i].w, 1);
    }
    EXPECT_EQ(moved, 1u);
}

// Found by gltf_fuzzer: these came out as exceptions of the JSON library.
TEST_F(AnimationsTest, PointersThatLeadThroughNoObjectAreFaults) {
    builder.set("/materials/0", R"({"extras": {"extensions": {"KHR_texture_transform": 5}}})");
    animate(pointer("/materials/0/extras/extensions/KHR_texture_transform/rotation"), {0}, {1}, "SCALAR");
    EXPECT_THAT(fault(), HasSubstr("KHR_texture_transform/rotation: no value can be put there"));
    builder = GltfBuilder::triangle();
    animate(pointer("/nodes/00/translation"), {0}, {1, 1, 1});
    EXPECT_THAT(fault(), HasSubstr("/nodes/00/translation: no value can be put there"));
}

TEST_F(AnimationsTest, FaultsAreNamedWithTheirPlace) {
    const auto expectFault = [&](auto change, const std::string& place, const std::string& words) {
        builder = GltfBuilder::triangle();
        change();
        const std::string text = fault();
        EXPECT_THAT(text, HasSubstr(place + ":"));
        EXPECT_THAT(text, HasSubstr(words));
    };
    const std::string sampler = "/animations/0/samplers/0", channel = "/animations/0/channels/0";
    expectFault(
        [&] {
            animate(node("translation"), {1, 0}, std::vector<float>(6));
        },
        sampler + "/input", "grow");
    expectFault(
        [&] {
            animate(node("translation"), {0, kNan}, std::vector<float>(6));
        },
        sampler + "/input", "finite");
    expectFault(
        [&] {
            animate(node("translation"), {0, 1}, std::vector<float>(9));
        },
        sampler + "/output", "9 numbers for 2 keys");
    expectFault(
        [&] {
            animate(node("translation"), {0, 1}, std::vector<float>(9), "VEC3", "CUBICSPLINE");
        },
        sampler + "/output", "with their tangents");
    expectFault(
        [&] {
            animate(node("translation"), {0}, {0, kNan, 0});
        },
        sampler + "/output", "number 1 is not finite");
    expectFault(
        [&] {
            animate(node("translation"), {0}, {0, 0, 0, 1}, "VEC4");
        },
        channel + "/sampler", "4 numbers a key");
    expectFault(
        [&] {
            animate(node("rotation"), {0}, {0, 0, 0, 0}, "VEC4");
        },
        channel + "/sampler", "quaternion");
    expectFault([&] { animate(node("weights"), {0}, {1}, "SCALAR"); }, channel + "/sampler", "has 0");
    expectFault(
        [&] {
            animate(R"({"node": 9, "path": "scale"})", {0}, {1, 1, 1});
        },
        channel + "/target/node", "/nodes/9");
    expectFault([&] { animate(pointer("/materials/4/alphaCutoff"), {0}, {1}, "SCALAR"); },
                channel + "/target", "nowhere");
    expectFault(
        [&] {
            animate(node("scale"), {0}, {1, 1, 1}, "VEC3", "BEZIER");
        },
        sampler + "/interpolation", "BEZIER");
    expectFault(
        [&] {
            animate(node("scale"), {0}, {1, 1, 1});
            builder.set("/nodes/0/matrix", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
        },
        channel + "/target", "matrix");
    expectFault(
        [&] {
            animate(node("scale"), {0}, {1, 1, 1});
            builder.set(channel + "/sampler", 5);
        },
        channel + "/sampler", "5");
}

}  // namespace
}  // namespace tilefarm
