// EXT_meshopt_compression and KHR_draco_mesh_compression, encoded here by their own libraries.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <meshoptimizer.h>

#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/accessors.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

struct MeshoptTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder;

    MeshoptTest() {
        // Decoded bytes live in a buffer that exists in name only.
        builder.set(
            "/buffers/1",
            R"({"byteLength": 65536, "extensions": {"EXT_meshopt_compression": {"fallback": true}}})");
        builder.set("/extensionsRequired", R"(["EXT_meshopt_compression"])");
    }

    /// A compressed view of count * stride decoded bytes; gives its index.
    uint32_t compressedView(std::span<const unsigned char> bytes, size_t count, size_t stride,
                            const char* mode, const char* filter = "NONE") {
        const uint32_t source = builder.view(std::as_bytes(bytes));
        const auto index = static_cast<uint32_t>(builder.size("/bufferViews"));
        const std::string place = fmt::format("/bufferViews/{}", index);
        builder.set(
            place,
            fmt::format(R"({{"buffer": 1, "byteLength": {}, "extensions": {{"EXT_meshopt_compression":
            {{"buffer": 0, "byteOffset": {}, "byteLength": {}, "byteStride": {}, "count": {}, "mode": "{}", "filter": "{}"}}}}}})",
                        count * stride, builder.offsetOf(source), bytes.size(), stride, count, mode, filter));
        return index;
    }

    template <typename T>
    uint32_t attributes(const std::vector<T>& values, size_t stride, const char* filter = "NONE") {
        const size_t count = values.size() * sizeof(T) / stride;
        std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(count, stride));
        bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), count, stride));
        return compressedView(bytes, count, stride, "ATTRIBUTES", filter);
    }

    template <typename Read>
    auto with(Read read) {
        const GltfFile file(builder.writeGltf(folder.path()));
        BufferViews views(file);
        Accessors accessors(file.root(), views);
        return read(accessors);
    }
};

TEST_F(MeshoptTest, DecodesAttributes) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 500; ++i) {
        points.emplace_back(std::sin(i), i * 0.25f, -i);
    }
    builder.accessorOf(attributes(points, 12), "VEC3", 5126, points.size());
    EXPECT_THAT(with([](Accessors& a) { return a.vec3s(0); }), ElementsAreArray(points));
}

TEST_F(MeshoptTest, DecodesTrianglesAndIndexSequences) {
    const std::vector<unsigned> list{0, 1, 2, 2, 1, 3, 4, 2, 3}, strip{5, 9, 1, 1, 7};
    std::vector<unsigned char> bytes(meshopt_encodeIndexBufferBound(list.size(), 5));
    meshopt_encodeIndexVersion(1);
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), list.data(), list.size()));
    builder.accessorOf(compressedView(bytes, list.size(), 2, "TRIANGLES"), "SCALAR", 5123, list.size());
    bytes.resize(meshopt_encodeIndexSequenceBound(strip.size(), 10));
    bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), strip.data(), strip.size()));
    builder.accessorOf(compressedView(bytes, strip.size(), 4, "INDICES"), "SCALAR", 5125, strip.size());
    EXPECT_THAT(with([](Accessors& a) { return a.integers(1); }), ElementsAreArray(strip));
    // The codec may rotate the corners of a triangle but keeps its winding.
    const std::vector<uint32_t> decoded = with([](Accessors& a) { return a.integers(0); });
    ASSERT_EQ(decoded.size(), list.size());
    for (size_t t = 0; t < list.size(); t += 3) {
        const auto* first = std::find(&decoded[t], &decoded[t] + 3, list[t]);
        ASSERT_NE(first, &decoded[t] + 3);
        EXPECT_EQ(decoded[t + size_t(first - &decoded[t] + 1) % 3], list[t + 1]);
    }
}

TEST_F(MeshoptTest, AppliesTheOctahedralFilter) {
    const std::vector<glm::vec4> normals{{0, 0, 1, 0}, {0.6f, 0, -0.8f, 0}, {-1, 0, 0, 0}};
    std::vector<int8_t> encoded(normals.size() * 4);
    meshopt_encodeFilterOct(encoded.data(), normals.size(), 4, 8, &normals[0].x);
    builder.accessorOf(attributes(encoded, 4, "OCTAHEDRAL"), "VEC4", 5120, normals.size(), true);
    const auto decoded = with([](Accessors& a) { return a.vec4s(0); });
    for (size_t i = 0; i < normals.size(); ++i) {
        EXPECT_LT(glm::length(glm::vec3(decoded[i] - normals[i])), 0.02f);
    }
}

TEST_F(MeshoptTest, AppliesTheQuaternionAndExponentialFilters) {
    const std::vector<glm::vec4> rotations{{0, 0, 0, 1}, {0.6f, 0, 0.8f, 0}};
    std::vector<int16_t> quaternions(8);
    meshopt_encodeFilterQuat(quaternions.data(), 2, 8, 16, &rotations[0].x);
    builder.accessorOf(attributes(quaternions, 8, "QUATERNION"), "VEC4", 5122, 2, true);
    const std::vector<float> values{0.1f, -1000, 3e-4f};
    std::vector<uint32_t> exponents(3);
    for (size_t i = 0; i < 3; ++i) {
        meshopt_encodeFilterExp(&exponents[i], 1, 4, 20, &values[i]);
    }
    builder.accessorOf(attributes(exponents, 4, "EXPONENTIAL"), "SCALAR", 5126, 3);
    const auto decoded = with([](Accessors& a) { return a.vec4s(0); });
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(std::abs(glm::dot(decoded[i], rotations[i])), 1, 1e-3);
    }
    const auto reals = with([](Accessors& a) { return a.scalars(1); });
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(reals[i], values[i], std::abs(values[i]) * 1e-5);
    }
}

TEST_F(MeshoptTest, ChecksItsLayout) {
    struct Case {
        const char *member, *value, *fault;
    };
    for (const Case& c :
         {Case{"byteStride", "13", "byteStride: must be a multiple of 4"},
          Case{"byteStride", "260", "byteStride: must be an integer of 0 … 256"},
          Case{"byteStride", "0", "byteStride: must be a multiple of 4"},
          Case{"count", "11", "count: gives 132 bytes, but the view has 120"},
          Case{"mode", "\"MAGIC\"", "mode: is \"MAGIC\""},
          Case{"filter", "\"MAGIC\"", "filter: is \"MAGIC\""},
          Case{"filter", "\"OCTAHEDRAL\"", "byteStride: must be 4 or 8"},
          Case{"filter", "\"QUATERNION\"", "byteStride: must be 8"},
          Case{"mode", "\"TRIANGLES\"", "byteStride: must be 2 or 4"},
          Case{"buffer", "9", "buffer: refers to /buffers/9"}, Case{"byteOffset", "999999", "lie outside"},
          Case{"byteLength", "3", "is malformed"}}) {
        builder = GltfBuilder();
        builder.set("/buffers/1", R"({"byteLength": 65536})");
        const uint32_t view = attributes(std::vector<glm::vec3>(10, glm::vec3(1, 2, 3)), 12);
        builder.accessorOf(view, "VEC3", 5126, 10);
        builder.set(fmt::format("/bufferViews/{}/extensions/EXT_meshopt_compression/{}", view, c.member),
                    c.value);
        EXPECT_THAT(errorOf([&] { with([](Accessors& a) { return a.vec3s(0); }); }).what(),
                    HasSubstr(c.fault));
    }
}

TEST_F(MeshoptTest, RefusesCountsThatItsBytesCannotHold) {
    const uint32_t view = attributes(std::vector<glm::vec3>(10, glm::vec3(1, 2, 3)), 12);
    const std::string place = fmt::format("/bufferViews/{}", view);
    builder.set("/buffers/1/byteLength", "12000000000");
    builder.accessorOf(view, "VEC3", 5126, 10);
    builder.set(place + "/byteLength", "12000000000");
    builder.set(place + "/extensions/EXT_meshopt_compression/count", "1000000000");
    EXPECT_THAT(errorOf([&] { with([](Accessors& a) { return a.vec3s(0); }); }).what(),
                HasSubstr("cannot hold 1000000000 elements"));
}

TEST_F(MeshoptTest, SaysWhatItsDecoderLacks) {
    const std::vector<uint8_t> colours(40, 7);
    const auto faultOf = [&](uint32_t view) {
        builder.accessorOf(view, "VEC4", 5121, 10);
        return errorOf([&] { with([&](Accessors& a) { return a.vec4s(uint32_t(a.count() - 1)); }); });
    };
    const uint32_t filtered = attributes(colours, 4, "COLOR");
    EXPECT_THAT(faultOf(filtered).what(), HasSubstr("the filter COLOR of KHR_meshopt_compression"));

    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(10, 4));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), colours.data(), 10, 4));
    bytes[0] = 0xa1;
    const uint32_t younger = compressedView(bytes, 10, 4, "ATTRIBUTES", "NONE");
    EXPECT_THAT(faultOf(younger).what(), HasSubstr("version 1 of the bitstream"));
}

TEST_F(MeshoptTest, ReadsUncompressedBytesWhereItCannotDecode) {
    const std::vector<uint8_t> colours(40, 7);
    const uint32_t plain = builder.view(std::as_bytes(std::span(colours)));
    const uint32_t view = attributes(colours, 4, "COLOR");
    builder.set(fmt::format("/bufferViews/{}/buffer", view), 0u);
    builder.set(fmt::format("/bufferViews/{}/byteOffset", view), builder.offsetOf(plain));
    builder.accessorOf(view, "VEC4", 5121, 10);
    EXPECT_EQ(with([](Accessors& a) { return a.vec4s(0); }).back(), glm::vec4(7));
}

TEST_F(MeshoptTest, BytesOfAFallbackBufferThatIsNotThereAreAnError) {
    builder.accessorOf(0, "SCALAR", 5126, 3);
    builder.set("/bufferViews/0", R"({"buffer": 1, "byteLength": 12})");
    EXPECT_THAT(errorOf([&] { with([](Accessors& a) { return a.scalars(0); }); }).what(),
                HasSubstr("/buffers/1: has no uri"));
}

struct DracoTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();
    static constexpr const char* kExtension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";

    /// Two triangles of a square with colours as normalised bytes; positions kept exact.
    DracoTest() {
        draco::TriangleSoupMeshBuilder soup;
        soup.Start(2);
        const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        const int color = soup.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
        const glm::vec3 corners[2][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                         {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
        const std::array<uint8_t, 4> red{255, 0, 51, 255};
        for (uint32_t f = 0; f < 2; ++f) {
            soup.SetAttributeValuesForFace(position, draco::FaceIndex(f), &corners[f][0].x, &corners[f][1].x,
                                           &corners[f][2].x);
            soup.SetAttributeValuesForFace(color, draco::FaceIndex(f), red.data(), red.data(), red.data());
        }
        const auto mesh = soup.Finalize();
        draco::EncoderBuffer out;
        EXPECT_TRUE(draco::Encoder().EncodeMeshToBuffer(*mesh, &out).ok());
        const uint32_t view = builder.view(std::as_bytes(std::span(out.data(), out.size())));
        builder.set(std::string(kExtension) + "/bufferView", view);
        builder.set(std::string(kExtension) + "/attributes",
                    fmt::format(R"({{"POSITION": {}, "COLOR_0": {}}})",
                                mesh->attribute(position)->unique_id(), mesh->attribute(color)->unique_id()));
        builder.set("/meshes/0/primitives/0/attributes", R"({"POSITION": 0, "COLOR_0": 1})");
        builder.set("/accessors", R"([{"type": "VEC3", "componentType": 5126, "count": 4},
            {"type": "VEC4", "componentType": 5121, "count": 4, "normalized": true},
            {"type": "SCALAR", "componentType": 5123, "count": 6}])");
        builder.set("/meshes/0/primitives/0/indices", 2)
            .set("/extensionsRequired", R"(["KHR_draco_mesh_compression"])");
    }
    Scene load() { return loadGltf(builder.writeGltf(folder.path())); }
};

TEST_F(DracoTest, DecodesTrianglesAndAttributes) {
    const Scene scene = load();
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.positions.size(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    double area = 0;
    for (glm::uvec3 t : mesh.triangles) {
        const glm::vec3 cross =
            glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
        EXPECT_GT(cross.z, 0) << "winding is kept";
        area += 0.5 * cross.z;
    }
    EXPECT_NEAR(area, 1, 1e-6);
    for (glm::vec4 color : mesh.colors) {
        EXPECT_EQ(color, glm::vec4(1, 0, 0.2f, 1));
    }
}

TEST_F(DracoTest, NamesWhatIsWrong) {
    builder.set(std::string(kExtension) + "/attributes/COLOR_0", "17");
    EXPECT_THAT(errorOf([&] { load(); }).what(), HasSubstr("/attributes/COLOR_0: is not an attribute of 4"));
    const std::vector<std::byte> junk(64, std::byte{3});
    builder.set(std::string(kExtension) + "/bufferView", builder.view(junk));
    EXPECT_THAT(errorOf([&] { load(); }).what(),
                HasSubstr("KHR_draco_mesh_compression: its compressed data is malformed"));
}

}  // namespace
}  // namespace tilefarm
