#include "worker/render/media.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

Material solidGlass() {
    Material m;
    m.transmission = 1;
    m.thickness = 1;
    return m;
}

glm::dmat4 placed(const glm::dvec3& at, double size) {
    return glm::scale(glm::translate(glm::dmat4(1), at), glm::dvec3(size));
}

Solids solidsOf(const Scene& scene) {
    return {scene, flatten(scene)};
}

const uint32_t kNo = gpu::NO_INDEX;

TEST(Media, HoldWhatIsInsideTheirSurface) {
    Scene scene;
    addMesh(scene, sphereMesh(12), solidGlass());
    const Solids solids = solidsOf(scene);
    EXPECT_FALSE(solids.nested());
    EXPECT_EQ(solids.mediaAt({0.1, -0.5, 0.2}), glm::uvec4(0, kNo, kNo, kNo));
    EXPECT_EQ(solids.mediaAt({0.7, 0.7, 0.7}), glm::uvec4(kNo)) << "in the box, not in the ball";
    EXPECT_EQ(solids.mediaAt({0, 0, 3}), glm::uvec4(kNo));
}

TEST(Media, OfMirroredInstancesHaveAnInsideToo) {
    Scene scene;
    addMesh(scene, cubeMesh(false), solidGlass(), glm::scale(glm::dmat4(1), {-1, 1, 1}));
    EXPECT_EQ(solidsOf(scene).mediaAt({0.5, 0.5, 0.5}).x, 0u);
}

TEST(Media, StandInOrderFromTheInnermost) {
    Scene scene;
    addMesh(scene, cubeMesh(false), solidGlass(), placed({0, 0, 0}, 3));
    addMesh(scene, cubeMesh(false), solidGlass(), placed({0, 0, 0}, 1));
    addMesh(scene, cubeMesh(false), solidGlass(), placed({0, 0, 0}, 2));
    const Solids solids = solidsOf(scene);
    EXPECT_TRUE(solids.nested());
    EXPECT_EQ(solids.mediaAt({0, 0, 0}), glm::uvec4(1, 2, 0, kNo));
    EXPECT_EQ(solids.mediaAt({1.5, 0, 0}), glm::uvec4(2, 0, kNo, kNo));
}

TEST(Media, AreTransmissiveSolidsAlone) {
    Scene scene;
    addMesh(scene, cubeMesh(false), matte(glm::vec3(0.5f)));
    Material pane = solidGlass();
    pane.thickness = 0;
    addMesh(scene, cubeMesh(false), pane, placed({0, 0, 0}, 2));
    EXPECT_EQ(solidsOf(scene).mediaAt({0, 0, 0}), glm::uvec4(kNo));
    EXPECT_FALSE(solidsOf(scene).nested());
}

TEST(Media, SolidsThatAreApartDoNotNest) {
    Scene scene;
    addMesh(scene, cubeMesh(false), solidGlass(), placed({-2, 0, 0}, 1));
    addMesh(scene, cubeMesh(false), solidGlass(), placed({2, 0, 0}, 1));
    EXPECT_FALSE(solidsOf(scene).nested());
}

TEST(Media, ShapesHaveAnInside) {
    const auto holds = [](ShapeKind kind, const glm::dvec3& size, const glm::dvec3& point) {
        Scene scene;
        scene.materials.push_back(solidGlass());
        Shape shape;
        shape.kind = kind;
        shape.size = size;
        shape.toWorld = glm::translate(glm::dmat4(1), {1, 0, 0});
        scene.shapes.push_back(shape);
        const WorldGeometry world = flatten(scene);
        return Solids(scene, world).mediaAt(point - world.centre).x == 0u;
    };
    EXPECT_TRUE(holds(ShapeKind::sphere, glm::dvec3(0.5), {1.3, 0.3, 0}));
    EXPECT_FALSE(holds(ShapeKind::sphere, glm::dvec3(0.5), {1.4, 0.4, 0}));
    EXPECT_TRUE(holds(ShapeKind::box, {1, 2, 3}, {1.9, -1.9, 2.9}));
    EXPECT_TRUE(holds(ShapeKind::cylinder, {1, 0.5, 0}, {1.4, -0.9, 0}));
    EXPECT_FALSE(holds(ShapeKind::cylinder, {1, 0.5, 0}, {1.4, 0.5, 0})) << "beside the cone's top";
    EXPECT_TRUE(holds(ShapeKind::capsule, {1, 0.5, 0.5}, {1, 1.4, 0}));
    EXPECT_FALSE(holds(ShapeKind::capsule, {1, 0.5, 0.5}, {1.4, 1.4, 0}));
}

}  // namespace
}  // namespace tilefarm
