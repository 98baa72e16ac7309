#include <gmock/gmock.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"
#include "worker/scene/triangulate.h"

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::string kPrimitive = "/meshes/0/primitives/0";

TEST(Triangulate, ReadsListsStripsAndFansWithTheirWinding) {
    const std::vector<uint32_t> v{10, 11, 12, 13, 14};
    EXPECT_THAT(triangulate(PrimitiveMode::triangles, v), ElementsAre(glm::uvec3(10, 11, 12)));
    EXPECT_THAT(triangulate(PrimitiveMode::triangleStrip, v),
                ElementsAre(glm::uvec3(10, 11, 12), glm::uvec3(11, 13, 12), glm::uvec3(12, 13, 14)));
    EXPECT_THAT(triangulate(PrimitiveMode::triangleFan, v),
                ElementsAre(glm::uvec3(11, 12, 10), glm::uvec3(12, 13, 10), glm::uvec3(13, 14, 10)));
    EXPECT_TRUE(triangulate(PrimitiveMode::triangleStrip, std::span(v).first(2)).empty());
    EXPECT_TRUE(triangulate(PrimitiveMode::lines, v).empty());
}

struct MeshesTest : testing::Test {
    TemporaryFolder folder;
    Scene load(GltfBuilder& builder) { return loadGltf(builder.writeGltf(folder.path())); }
    std::string faultOf(GltfBuilder& builder) {
        return errorOf([&] { load(builder); }).what();
    }
};

TEST_F(MeshesTest, ReadsEveryAttributeAndIndexType) {
    for (uint32_t type : {5121u, 5123u, 5125u}) {
        GltfBuilder builder = GltfBuilder::square();
        const uint32_t indices = type == 5121   ? builder.accessor(std::vector<uint8_t>{0, 1, 2}, "SCALAR")
                                 : type == 5123 ? builder.accessor(std::vector<uint16_t>{0, 1, 2}, "SCALAR")
                                                : builder.accessor(std::vector<uint32_t>{0, 1, 2}, "SCALAR");
        builder.set(kPrimitive + "/indices", indices);
        builder.set(kPrimitive + "/attributes/TEXCOORD_1",
                    builder.accessor(std::vector<uint8_t>{0, 255, 0, 0, 255, 255, 0, 0}, "VEC2", true));
        builder.set("/accessors/5/normalized", "true");
        builder.set(kPrimitive + "/attributes/COLOR_0",
                    builder.accessor(std::vector<uint16_t>{65535, 0, 0, 0, 65535, 0, 0, 0, 65535, 0, 0, 0},
                                     "VEC3", true));
        const Scene scene = load(builder);
        const Mesh& mesh = scene.meshes.at(0);
        EXPECT_THAT(mesh.triangles, ElementsAre(glm::uvec3(0, 1, 2)));
        EXPECT_THAT(mesh.positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0)))
            << "the vertex that no triangle uses is gone";
        EXPECT_EQ(mesh.normals[1], glm::vec3(0, 0, 1));
        EXPECT_EQ(mesh.uv0[1], glm::vec2(1, 1));
        EXPECT_EQ(mesh.uv1[0], glm::vec2(0, 1));
        EXPECT_EQ(mesh.colors[1], glm::vec4(0, 1, 0, 1)) << "three components get an alpha of 1";
        EXPECT_TRUE(mesh.tangents.empty()) << "no normal map, no tangents";
    }
}

TEST_F(MeshesTest, ReadsQuantisedPositions) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/extensionsRequired", R"(["KHR_mesh_quantization"])");
    builder.set(kPrimitive + "/attributes/POSITION",
                builder.accessor(std::vector<int16_t>{0, 0, 0, 1000, 0, 0, 0, -500, 7}, "VEC3"));
    EXPECT_THAT(load(builder).meshes.at(0).positions,
                ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1000, 0, 0), glm::vec3(0, -500, 7)));
}

TEST_F(MeshesTest, WarnsOfPointsAndLinesAndOfWhatHasNoPositions) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/meshes/0/name", R"("Dots")");
    builder.set(kPrimitive + "/mode", 0);
    builder.set("/meshes/0/primitives/1", R"({"attributes": {"POSITION": 0}, "mode": 3})");
    builder.set("/meshes/0/primitives/2", R"({"attributes": {}})");
    const Scene scene = load(builder);
    EXPECT_TRUE(scene.meshes.empty());
    ASSERT_EQ(scene.warnings.size(), 3u);
    EXPECT_EQ(scene.warnings[0].feature, "points");
    EXPECT_EQ(scene.warnings[1].where, "meshes/0/primitives/1");
    EXPECT_EQ(scene.warnings[2].feature, "POSITION");
}

TEST_F(MeshesTest, ChecksWhatPrimitivesReferTo) {
    struct Case {
        std::string pointer, json, fault;
    };
    for (const Case& c :
         {Case{kPrimitive + "/indices", "9", "/meshes/0/primitives/0/indices: refers to /accessors/9"},
          Case{kPrimitive + "/attributes/POSITION", "9", "/attributes/POSITION: refers to /accessors/9"},
          Case{kPrimitive + "/attributes/NORMAL", "2", "/accessors/2/type: must be VEC3 here"},
          Case{kPrimitive + "/material", "1", "/material: refers to /materials/1"},
          Case{kPrimitive + "/mode", "7", "/mode: must be an integer of 0 … 6"},
          Case{kPrimitive + "/indices", "0", "/accessors/0: must be a SCALAR"},
          Case{"/accessors/1/count", "3", "/attributes/NORMAL: has 3 elements, but POSITION has 4"},
          Case{"/accessors/0/count", "3", "/attributes/NORMAL: has 4 elements, but POSITION has 3"},
          Case{kPrimitive + "/attributes", "[]",
               "/meshes/0/primitives/0/attributes: must be an object, is array"},
          Case{"/meshes/0/primitives", "{}", "/meshes/0/primitives: must be an array, is object"},
          Case{"/nodes/0/mesh", "1", "/nodes/0/mesh: refers to /meshes/1"}}) {
        GltfBuilder builder = GltfBuilder::square();
        builder.set(c.pointer, c.json);
        EXPECT_THAT(faultOf(builder), HasSubstr(c.fault));
    }
}

TEST_F(MeshesTest, ChecksEveryIndex) {
    GltfBuilder outside = GltfBuilder::square();
    outside.set(kPrimitive + "/indices", outside.accessor(std::vector<uint16_t>{0, 1, 4}, "SCALAR"));
    EXPECT_THAT(faultOf(outside), HasSubstr("/meshes/0/primitives/0/indices: element 2 refers to vertex 4"));
    GltfBuilder restart = GltfBuilder::square();
    restart.set(kPrimitive + "/indices", restart.accessor(std::vector<uint8_t>{0, 255, 1}, "SCALAR"));
    EXPECT_THAT(faultOf(restart), HasSubstr("/indices: element 1 is 255, a primitive restart value"));
}

TEST_F(MeshesTest, DropsAndCountsDegenerateTriangles) {
    GltfBuilder builder;
    const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0},    {0, 1, 0},
                                           {2, 0, 0}, {kNan, 0, 0}, {0, 1, 0}};
    builder.set(kPrimitive + "/attributes/POSITION", builder.accessor(positions));
    builder.set(
        kPrimitive + "/indices",
        builder.accessor(std::vector<uint16_t>{0, 1, 2, 0, 0, 1, 0, 1, 3, 0, 1, 4, 0, 2, 5}, "SCALAR"));
    builder.set("/nodes/0/mesh", 0).set("/scenes/0/nodes/0", 0);
    const Scene scene = load(builder);
    EXPECT_EQ(scene.degenerateTriangles, 4u) << "repeated index, collinear, not finite, repeated position";
    EXPECT_THAT(scene.meshes.at(0).triangles, ElementsAre(glm::uvec3(0, 1, 2)));
    EXPECT_EQ(scene.meshes.at(0).positions.size(), 3u);
}

TEST_F(MeshesTest, KeepsThinTrianglesThatHaveAnArea) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set(kPrimitive + "/attributes/POSITION",
                builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-30f, 0}}));
    EXPECT_EQ(load(builder).degenerateTriangles, 0u);
}

TEST_F(MeshesTest, CornersWithoutAUsableNormalGetTheGeometricOne) {
    GltfBuilder builder = GltfBuilder::square();
    const glm::vec3 slanted(0, 3, 4);
    builder.set(kPrimitive + "/attributes/NORMAL",
                builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, slanted, slanted, {kNan, 0, 1}}));
    const Mesh mesh = load(builder).meshes.at(0);
    EXPECT_EQ(mesh.normals[mesh.triangles[0].x], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[mesh.triangles[1].z], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[mesh.triangles[0].y], glm::vec3(0, 0.6f, 0.8f)) << "made unit length";
    EXPECT_EQ(mesh.positions[mesh.triangles[1].z], glm::vec3(0, 1, 0));
    EXPECT_EQ(mesh.uv0[mesh.triangles[1].z], glm::vec2(0, 0));
}

TEST_F(MeshesTest, AMeshWithNoUsableNormalHasNone) {
    GltfBuilder builder = GltfBuilder::square();
    builder.set(kPrimitive + "/attributes/NORMAL", builder.accessor(std::vector<glm::vec3>(4, glm::vec3(0))));
    EXPECT_TRUE(load(builder).meshes.at(0).normals.empty());
}

TEST_F(MeshesTest, PrimitivesWithoutMaterialShareTheDefaultOne) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/materials/0", R"({"name": "unused"})");
    const Scene scene = load(builder);
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.meshes.at(0).material, 1u);
    EXPECT_EQ(scene.materials[1].metallic, 1.0f);
}

TEST_F(MeshesTest, BlendsMorphTargetsByTheirDefaultWeights) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set(kPrimitive + "/targets/0/POSITION",
                builder.accessor(std::vector<glm::vec3>{{0, 0, 4}, {0, 0, 0}, {0, 2, 0}}));
    builder.set("/meshes/0/weights", "[0.5]");
    builder.set("/nodes/1", R"({"mesh": 0, "weights": [1]})").set("/scenes/0/nodes/1", 1);
    const Scene scene = load(builder);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_THAT(scene.meshes[0].positions,
                ElementsAre(glm::vec3(0, 0, 2), glm::vec3(1, 0, 0), glm::vec3(0, 2, 0)));
    EXPECT_EQ(scene.meshes[scene.instances[1].mesh].positions[0], glm::vec3(0, 0, 4)) << "the node's weights";
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(MeshesTest, WarnsWhereVerticesAreTooFarFromTheirOrigin) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set(kPrimitive + "/attributes/POSITION",
                builder.accessor(std::vector<glm::vec3>{{1e4f, 0, 0}, {1e4f + 1, 0, 0}, {1e4f, 1, 0}}));
    const Scene scene = load(builder);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].feature, "precision loss");
}

TEST_F(MeshesTest, ReadsAMeshOnceForAllItsNodes) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.set("/nodes/1", R"({"mesh": 0, "translation": [1, 2, 3]})").set("/scenes/0/nodes/1", 1);
    const Scene scene = load(builder);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 2u);
}

}  // namespace
}  // namespace tilefarm
