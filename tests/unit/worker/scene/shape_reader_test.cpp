// KHR_implicit_shapes and TILEFARM_shapes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/error/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

class ShapeReaderTest : public testing::Test {
protected:
    Scene load(GltfBuilder& builder) { return loadGltf(builder.writeGltf(folder.path())); }

    /// Node 0 shows implicit shape 0.
    Scene implicitScene(const std::string& shape) {
        GltfBuilder builder;
        builder.set("/extensions/KHR_implicit_shapes/shapes/0", shape);
        builder.set("/nodes/0", R"({"extensions": {"TILEFARM_shapes": {"shape": 0}}})");
        builder.set("/scenes/0/nodes", "[0]");
        return load(builder);
    }

    Scene surfaceScene(const std::string& surface) {
        GltfBuilder builder;
        builder.set("/extensions/TILEFARM_shapes/surfaces/0", surface);
        builder.set("/nodes/0",
                    R"({"translation": [1, 2, 3], "extensions": {"TILEFARM_shapes": {"surface": 0}}})");
        builder.set("/scenes/0/nodes", "[0]");
        return load(builder);
    }

    std::string fault(const std::string& surface) {
        try {
            surfaceScene(surface);
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::invalidArgument);
            return error.what();
        }
        return "no fault";
    }

    TemporaryFolder folder;
};

TEST_F(ShapeReaderTest, ReadsEveryImplicitShapeWithItsDefaults) {
    EXPECT_EQ(implicitScene(R"({"type": "sphere", "sphere": {"radius": 2}})").shapes.at(0).size.x, 2);
    EXPECT_EQ(implicitScene(R"({"type": "sphere"})").shapes.at(0).size.x, 0.5);
    const Scene box = implicitScene(R"({"type": "box", "box": {"size": [1, 2, 3]}})");
    EXPECT_EQ(box.shapes.at(0).kind, ShapeKind::box);
    EXPECT_EQ(box.shapes[0].size, glm::dvec3(0.5, 1, 1.5));
    const Scene cone = implicitScene(
        R"({"type": "cylinder", "cylinder": {"height": 3, "radiusBottom": 1, "radiusTop": 0}})");
    EXPECT_EQ(cone.shapes.at(0).kind, ShapeKind::cylinder);
    EXPECT_EQ(cone.shapes[0].size, glm::dvec3(1.5, 1, 0));
    EXPECT_EQ(implicitScene(R"({"type": "capsule"})").shapes.at(0).size, glm::dvec3(0.25));
    const Scene plane = implicitScene(R"({"type": "plane", "plane": {"sizeX": 4, "sizeZ": 2}})");
    EXPECT_EQ(plane.shapes.at(0).kind, ShapeKind::rectangle);
    EXPECT_EQ(glm::dvec3(plane.shapes[0].toWorld[2]), glm::dvec3(0, 1, 0)) << "its front is up";
    const ShapeBounds bounds = boundsOf(plane.shapes[0]);
    EXPECT_EQ(bounds.upper - bounds.lower, glm::dvec3(4, 0, 2));
}

TEST_F(ShapeReaderTest, WarnsOfWhatItRendersOtherwise) {
    EXPECT_THAT(implicitScene(R"({"type": "plane"})").warnings.at(0).instead, testing::HasSubstr("square"));
    GltfBuilder builder;
    builder.set("/extensions/KHR_implicit_shapes/shapes/0", R"({"type": "capsule"})");
    builder.set("/materials/0", R"({"emissiveFactor": [1, 1, 1]})");
    builder.set("/nodes/0", R"({"extensions": {"TILEFARM_shapes": {"shape": 0, "material": 0}}})");
    builder.set("/scenes/0/nodes", "[0]");
    const Scene scene = load(builder);
    EXPECT_EQ(scene.shapes.at(0).material, 0u);
    EXPECT_EQ(scene.warnings.at(0).instead,
              "emissive capsule: not sampled as a light, so its light is noisier");
}

TEST_F(ShapeReaderTest, CompilesFieldsToPostfixOrder) {
    const Scene scene = surfaceScene(
        R"({"field": {"smooth": 0.2, "translation": [1, 0, 0], "rotation": [0, 0, 0.70710678, 0.70710678],
        "union": [{"sphere": {"radius": 1}, "translation": [2, 0, 0]}, {"torus": {"radius": 1, "tube": 0.25}},
                  {"difference": [{"box": {"size": [2, 2, 2]}}, {"cone": {"height": 1}}]}]}})");
    const Shape& shape = scene.shapes.at(0);
    EXPECT_EQ(glm::dvec3(shape.toWorld[3]), glm::dvec3(1, 2, 3));
    std::vector<FieldOperation> operations;
    for (const FieldInstruction& i : shape.field) operations.push_back(i.operation);
    using enum FieldOperation;
    EXPECT_THAT(operations, testing::ElementsAre(sphere, torus, unite, box, cone, subtract, unite));
    // A quarter turn about z brings +x to +y.
    EXPECT_NEAR(glm::distance(shape.field[0].translation, glm::dvec3(1, 2, 0)), 0, 1e-7);
    EXPECT_EQ(shape.field[2].parameters.x, 0.2);
    EXPECT_EQ(shape.field[5].parameters.x, 0);
}

TEST_F(ShapeReaderTest, RefusesWhatCannotBeRendered) {
    EXPECT_THAT(fault(R"({"field": {"sphere": {"radius": -1}}})"),
                testing::HasSubstr("/field/sphere/radius"));
    EXPECT_THAT(fault(R"({"field": {}})"), testing::HasSubstr("must have one of"));
    EXPECT_THAT(fault(R"({"field": {"union": []}})"), testing::HasSubstr("must not be empty"));
    EXPECT_THAT(
        fault(
            R"({"field": {"intersection": [{"sphere": {"radius": 1}, "translation": [9, 0, 0]}, {"sphere": {"radius": 1}}]}})"),
        testing::HasSubstr("is empty"));
    std::string many = R"({"sphere": {"radius": 1}})";
    for (int i = 0; i < 40; ++i) many += R"(, {"sphere": {"radius": 1}})";
    EXPECT_THAT(fault(R"({"field": {"union": [)" + many + "]}}"),
                testing::HasSubstr("more than 64 operations"));
    std::string deep = R"({"sphere": {"radius": 1}})";
    for (int i = 0; i < 9; ++i) deep = R"({"union": [{"sphere": {"radius": 1}}, )" + deep + "]}";
    EXPECT_THAT(fault(R"({"field": )" + deep + "}"), testing::HasSubstr("waiting at once"));
    EXPECT_THAT(fault(R"({"disk": {"radius": 0}})"), testing::HasSubstr("above 0"));
}

TEST_F(ShapeReaderTest, ShapesFollowTheTrianglesInTheWorld) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/extensions/KHR_implicit_shapes/shapes/0", R"({"type": "sphere"})");
    builder.set("/nodes/1", R"({"translation": [5, 0, 0], "extensions": {"TILEFARM_shapes": {"shape": 0}}})");
    builder.set("/scenes/0/nodes", "[0, 1]");
    const WorldGeometry world = flatten(load(builder));
    EXPECT_EQ(world.triangleCount(), 1u);
    EXPECT_EQ(world.primitiveCount(), 2u);
    const WorldShape& sphere = world.shapes.at(0);
    const glm::dvec3 lower = glm::dvec3(sphere.lower) + world.centre;
    EXPECT_LE(lower.x, 4.5);
    EXPECT_NEAR(lower.x, 4.5, 1e-4);
    EXPECT_EQ(sphere.areaLight, kNone);
}

TEST_F(ShapeReaderTest, CollapsedShapesAreLeftOutAndCounted) {
    Scene scene;
    scene.materials.emplace_back();
    scene.shapes.emplace_back();
    scene.shapes[0].toWorld[0][0] = 0;
    const WorldGeometry world = flatten(scene);
    EXPECT_TRUE(world.shapes.empty());
    EXPECT_EQ(world.degenerateShapes, 1u);
}

}  // namespace
}  // namespace tilefarm
