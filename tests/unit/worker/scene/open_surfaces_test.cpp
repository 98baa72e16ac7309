// Which surfaces enclose something, and that the others are thin-walled.
#include "worker/scene/open_surfaces.h"
#include "shared/job/appearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"
#include "worker/scene/gltf_source.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

using testing::Each;
using testing::HasSubstr;

const std::filesystem::path kSharedFolder = TILEFARM_SHARED_DATA;

std::vector<bool> openOf(const Mesh& mesh) {
    const Mesh* meshes[] = {&mesh};
    return openTriangles(meshes).at(0);
}

void append(Mesh& to, const Mesh& mesh, const glm::vec3& by) {
    const auto first = static_cast<uint32_t>(to.positions.size());
    for (const glm::vec3& p : mesh.positions) to.positions.push_back(p + by);
    for (const glm::uvec3& t : mesh.triangles) to.triangles.push_back(t + first);
}

/// Around y, of radius 1, without caps; the corners of its seam differ in the last digits.
Mesh tubeMesh(float height, int columns) {
    Mesh mesh;
    for (int i = 0; i <= columns; ++i) {
        const auto phi = static_cast<float>(2 * std::numbers::pi * i / columns);
        for (const float y : {0.f, height}) mesh.positions.emplace_back(std::cos(phi), y, std::sin(phi));
    }
    for (uint32_t i = 0; i < 2u * static_cast<uint32_t>(columns); i += 2) {
        mesh.triangles.emplace_back(i, i + 1, i + 2);
        mesh.triangles.emplace_back(i + 2, i + 1, i + 3);
    }
    return mesh;
}

Mesh turnedEveryOther(Mesh mesh) {
    for (size_t i = 0; i < mesh.triangles.size(); i += 2) std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
    return mesh;
}

TEST(OpenTriangles, AreNoneOfWhatEnclosesSomething) {
    EXPECT_THAT(openOf(cubeMesh(false)), Each(false)) << "faces with corners of their own";
    EXPECT_THAT(openOf(cubeMesh(true)), Each(false));
    EXPECT_THAT(openOf(sphereMesh(8)), Each(false)) << "a seam and poles";
    EXPECT_THAT(openOf(turnedEveryOther(cubeMesh(false))), Each(false));
    Mesh pair = cubeMesh(false);
    append(pair, cubeMesh(false), {2, 2, 0});
    EXPECT_THAT(openOf(pair), Each(false)) << "two cubes that share an edge";
}

TEST(OpenTriangles, AreAllOfWhatHasAnEdge) {
    const Mesh plane = quadMesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_THAT(openOf(plane), Each(true));
    EXPECT_THAT(openOf(turnedEveryOther(plane)), Each(true)) << "whose areas cancel";
    EXPECT_THAT(openOf(tubeMesh(2, 16)), Each(true)) << "whose holes cancel";
    EXPECT_THAT(openOf(tubeMesh(100, 16)), Each(true)) << "each hole is 0.5 % of it";
    Mesh box = cubeMesh(false);
    box.triangles.resize(10);
    EXPECT_THAT(openOf(box), Each(true)) << "a side is missing";
    Mesh pane = plane;
    append(pane, plane, {0, 0, 0.01f});
    EXPECT_THAT(openOf(pane), Each(true)) << "front and back without the narrow sides";
}

TEST(OpenTriangles, AreNoneBesideCracksThatLetNoLightThrough) {
    // One side of the cube has its corners and one more in the middle of an edge.
    Mesh cracked = cubeMesh(false);
    const glm::uvec3 last = cracked.triangles.back();
    const auto middle = static_cast<uint32_t>(cracked.positions.size());
    cracked.positions.push_back(0.5f * (cracked.positions[last.y] + cracked.positions[last.z]));
    cracked.triangles.back() = {last.x, last.y, middle};
    cracked.triangles.emplace_back(last.x, middle, last.z);
    EXPECT_THAT(openOf(cracked), Each(false));

    // Corners that differ by less than shows, on either side of what is rounded to one.
    Mesh seam = sphereMesh(16);
    for (size_t i = 0; i < seam.positions.size(); i += 3) seam.positions[i] *= 1.000001f;
    EXPECT_THAT(openOf(seam), Each(false));
    Mesh pinhole = sphereMesh(64);
    pinhole.triangles.pop_back();
    EXPECT_THAT(openOf(pinhole), Each(false));
}

TEST(OpenTriangles, AreThoseOfTheOpenSurfacesAlone) {
    Mesh both = cubeMesh(false);
    append(both, quadMesh({3, 0, 0}, {1, 0, 0}, {0, 1, 0}), glm::vec3(0));
    const std::vector<bool> open = openOf(both);
    for (size_t i = 0; i < open.size(); ++i) EXPECT_EQ(open[i], i >= 12) << i;
}

TEST(OpenTriangles, KnowWhatPrimitivesEncloseTogetherOrAlone) {
    Mesh bottle = cubeMesh(false), cork = bottle, shelf = quadMesh({-5, -1, -5}, {10, 0, 0}, {0, 0, 10});
    bottle.triangles.resize(10);
    cork.triangles.erase(cork.triangles.begin(), cork.triangles.begin() + 10);
    cork.material = 1;
    shelf.material = 2;
    const Mesh* closed[] = {&bottle, &cork};
    for (const auto& open : openTriangles(closed)) EXPECT_THAT(open, Each(false)) << "by another material";

    Mesh ledge = quadMesh({-1, -1, -1}, {2, 0, 0}, {0, 0, -1});  // at an edge of the cube
    ledge.material = 1;
    const Mesh glass = cubeMesh(false);
    const Mesh* beside[] = {&glass, &ledge};
    const auto open = openTriangles(beside);
    EXPECT_THAT(open[0], Each(false));
    EXPECT_THAT(open[1], Each(true));
}

TEST(OpenTriangles, LiveWithTrianglesThatAreNone) {
    Mesh mesh = cubeMesh(false);
    mesh.positions.emplace_back(NAN, 0, 0);
    mesh.positions.emplace_back(INFINITY, 0, 0);
    mesh.triangles.emplace_back(0, 24, 25);
    mesh.triangles.emplace_back(3, 3, 3);
    EXPECT_THAT(openOf(mesh), Each(false));
    EXPECT_TRUE(openOf(Mesh{}).empty());
}

class OpenVolumes : public testing::Test {
protected:
    /// A square of glass 0.5 m thick, half of whose light is left after 1 m, with changes.
    GltfBuilder window() {
        GltfBuilder builder = GltfBuilder::square();
        builder.set("/materials/0", R"({"name": "Glass", "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": 0.5, "attenuationDistance": 1,
                                     "attenuationColor": [0.25, 1, 1]}}})");
        return builder;
    }
    TemporaryFolder folder;
};

TEST_F(OpenVolumes, AreThinAndSaidToBe) {
    const Scene scene = loadGltf(window().writeGltf(folder.path()));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "KHR_materials_volume");
    EXPECT_EQ(scene.warnings[0].where, "meshes/0/primitives/0");
    EXPECT_THAT(scene.warnings[0].instead, HasSubstr("thin-walled"));

    const WorldGeometry world = flatten(scene);
    const Material& pane = world.materialOf(scene, world.instances.at(0).material);
    EXPECT_EQ(pane.thickness, 0);
    EXPECT_EQ(pane.baseColor, glm::vec3(0.5f, 1, 1)) << "as much as half a metre absorbs";
    EXPECT_EQ(pane.name, "Glass");
    EXPECT_EQ(scene.materials[0].thickness, 0.5f) << "closed surfaces of it stay solid";
}

TEST_F(OpenVolumes, ShareAMeshWithClosedOnes) {
    Mesh both = cubeMesh(false);
    append(both, quadMesh({3, 0, 0}, {1, 0, 0}, {0, 1, 0}), glm::vec3(0));
    std::vector<uint32_t> indices;
    for (const glm::uvec3& t : both.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
    GltfBuilder builder = window();
    builder.set("/meshes/0/primitives/0/attributes", "{}");
    builder.set("/meshes/0/primitives/0/attributes/POSITION", builder.accessor(both.positions));
    builder.set("/meshes/0/primitives/0/indices", builder.accessor(indices, "SCALAR"));
    const Scene scene = loadGltf(builder.writeGltf(folder.path()));
    const WorldGeometry world = flatten(scene);
    ASSERT_EQ(world.instances.size(), 2u);
    EXPECT_EQ(world.instances[0].triangleCount, 12u);
    EXPECT_TRUE(isSolid(world.materialOf(scene, world.instances[0].material)));
    EXPECT_EQ(world.instances[1].triangleCount, 2u);
    EXPECT_FALSE(isSolid(world.materialOf(scene, world.instances[1].material)));
}

TEST_F(OpenVolumes, MayBeWhatAJobMakesSolid) {
    GltfBuilder builder = window();
    builder.erase("/materials/0/extensions/KHR_materials_volume");
    const auto path = builder.writeGltf(folder.path());
    EXPECT_TRUE(loadGltf(path).warnings.empty());
    MaterialOverride thick;
    thick.material = "Glass";
    thick.thickness = 1;
    GltfOptions options;
    options.materials = {thick};
    const Scene scene = GltfSource(path, options).take();
    ASSERT_EQ(scene.warnings.size(), 1u);
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.materialOf(scene, world.instances.at(0).material).thickness, 0);
}

TEST_F(OpenVolumes, AreFlatShapesToo) {
    GltfBuilder builder = window();
    builder.set("/extensions/KHR_implicit_shapes/shapes/0",
                R"({"type": "plane", "plane": {"sizeX": 1, "sizeZ": 1}})");
    builder.set("/nodes/0", R"({"extensions": {"TILEFARM_shapes": {"shape": 0, "material": 0}}})");
    const Scene scene = loadGltf(builder.writeGltf(folder.path()));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].where, "nodes/0");
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.materialOf(scene, world.shapes.at(0).shape.material).thickness, 0);
}

TEST_F(OpenVolumes, OfTheSharedCaseIsFound) {
    const auto path = kSharedFolder / "cases/glass-open-volume/volume.gltf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
    const Scene scene = loadGltf(path);
    ASSERT_EQ(scene.warnings.size(), 1u);
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.materialOf(scene, world.instances.at(0).material).thickness, 0);
}

}  // namespace
}  // namespace tilefarm
