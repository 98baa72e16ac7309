#include "worker/scene/world.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace tilefarm {
namespace {

/// A triangle in the xy plane that faces +z, with every attribute.
Scene oneTriangle(const glm::dmat4& toWorld) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.tangents.assign(3, {1, 0, 0, 1});
    mesh.uv0 = {{0, 1}, {1, 1}, {0, 0}};
    mesh.triangles = {{0, 1, 2}};
    Scene scene;
    scene.materials.emplace_back();
    scene.meshes = {mesh};
    scene.instances = {{0, toWorld, "node"}};
    return scene;
}

glm::vec3 geometricNormal(const WorldGeometry& world, uint32_t triangle) {
    const std::vector<glm::vec3> c = world.corners();
    return glm::normalize(
        glm::cross(c[triangle * 3 + 1] - c[triangle * 3], c[triangle * 3 + 2] - c[triangle * 3]));
}

TEST(World, KeepsASceneAroundItsOriginWhereItIs) {
    const WorldGeometry world = flatten(oneTriangle(glm::translate(glm::dmat4(1), {-0.5, -0.25, 0.125})));
    EXPECT_EQ(world.centre, glm::dvec3(0));
    EXPECT_EQ(world.positions[1], glm::vec3(0.5f, -0.25f, 0.125f));
    EXPECT_EQ(world.lower, glm::vec3(-0.5f, -0.25f, 0.125f));
    EXPECT_EQ(world.upper, glm::vec3(0.5f, 0.75f, 0.125f));
}

TEST(World, KeepsTheBitsOfASceneFarFromItsOrigin) {
    const glm::dvec3 far(1e6 + 0.3, -3e7 - 0.7, 2e5 + 0.1);
    const WorldGeometry world = flatten(oneTriangle(glm::translate(glm::dmat4(1), far)));
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(std::abs(world.centre[k] - far[k]), 2.0);
        EXPECT_EQ(world.centre[k], std::round(world.centre[k])) << "on the grid of a scene one unit wide";
        EXPECT_NEAR(world.centre[k] + world.positions[0][k], far[k], 1e-7);
    }
}

TEST(World, MovesLightsAndCamerasAlong) {
    Scene scene = oneTriangle(glm::translate(glm::dmat4(1), {1e6, 0, 0}));
    scene.lights.emplace_back();
    scene.lights[0].position = {1e6 + 2, 3, 4};
    Camera camera;
    camera.toWorld = glm::translate(glm::dmat4(1), {1e6, 0, 5});
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.lights[0].position + world.centre, scene.lights[0].position);
    EXPECT_EQ(glm::dvec3(world.recentred(camera).toWorld[3]) + world.centre, glm::dvec3(camera.toWorld[3]));
}

TEST(World, MirroredInstanceFacesTheSameWayAndFlipsHandedness) {
    const Scene scene = oneTriangle(glm::scale(glm::dmat4(1), {-1, 1, 1}));
    const WorldGeometry world = flatten(scene);
    EXPECT_TRUE(world.instances[0].mirrored);
    EXPECT_EQ(geometricNormal(world, 0), glm::vec3(0, 0, 1));
    EXPECT_EQ(world.normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(world.tangents[0], glm::vec4(-1, 0, 0, -1));
    // The bitangent, cross(normal, tangent) * w, still follows the mesh's +y.
    EXPECT_EQ(glm::cross(world.normals[0], glm::vec3(world.tangents[0])) * world.tangents[0].w,
              glm::vec3(0, 1, 0));
}

TEST(World, NormalsStayPerpendicularUnderNonUniformScale) {
    Scene scene =
        oneTriangle(glm::rotate(glm::dmat4(1), 0.7, {1, 2, 3}) * glm::scale(glm::dmat4(1), {1, 10, 0.1}) *
                    glm::rotate(glm::dmat4(1), 1.1, {3, 1, 1}));
    const WorldGeometry world = flatten(scene);
    EXPECT_NEAR(glm::dot(world.normals[0], geometricNormal(world, 0)), 1, 1e-6);
    EXPECT_NEAR(glm::dot(world.normals[0], glm::vec3(world.tangents[0])), 0, 1e-6);
    EXPECT_NEAR(glm::length(glm::vec3(world.tangents[0])), 1, 1e-6);
}

TEST(World, ListsEmissiveTrianglesWithTheirWorldArea) {
    Scene scene = oneTriangle(glm::scale(glm::dmat4(1), {2, 3, 1}));
    scene.instances.push_back(scene.instances[0]);
    scene.materials[0].emission = {0, 5, 0};
    const WorldGeometry world = flatten(scene);
    ASSERT_EQ(world.emissive.size(), 2u);
    EXPECT_EQ(world.emissive[1].triangle, 1u);
    EXPECT_DOUBLE_EQ(world.emissive[1].area, 3.0);
    EXPECT_EQ(world.instanceOf(1).firstVertex, 3u);
    EXPECT_EQ(world.triangles[1], glm::uvec3(3, 4, 5));
}

TEST(World, DropsAndCountsCollapsedTriangles) {
    Scene scene = oneTriangle(glm::dmat4(1));
    scene.instances.push_back({0, glm::scale(glm::dmat4(1), {1, 0, 1}), "flat"});
    scene.instances.push_back({0, glm::scale(glm::dmat4(1), {1e300, 1e300, 1}), "huge"});
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.triangleCount(), 1u);
    EXPECT_EQ(world.degenerateTriangles, 2u);
    EXPECT_EQ(world.upper, glm::vec3(1, 1, 0));
}

TEST(World, FillsInAttributesThatOnlySomeMeshesHave) {
    Scene scene = oneTriangle(glm::dmat4(1));
    Mesh plain;
    plain.positions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    plain.colors.assign(3, {1, 0, 0, 1});
    plain.triangles = {{0, 1, 2}};
    scene.meshes.push_back(plain);
    scene.instances.push_back({1, glm::dmat4(1), "plain"});
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.normals[3], glm::vec3(0));
    EXPECT_EQ(world.tangents[3].w, 0);
    EXPECT_EQ(world.uv0[3], glm::vec2(0));
    EXPECT_EQ(world.colors[0], glm::vec4(1));
    EXPECT_EQ(world.colors[3], glm::vec4(1, 0, 0, 1));
    EXPECT_TRUE(world.uv1.empty());
}

TEST(World, TakesAnEmptyScene) {
    Scene scene;
    scene.materials.emplace_back();
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.triangleCount(), 0u);
    EXPECT_EQ(world.centre, glm::dvec3(0));
    EXPECT_EQ(world.lower, world.upper);
}

}  // namespace
}  // namespace tilefarm
