#include "tests/fuzz/seed_file.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <stdexcept>

namespace tilefarm {

GltfBuilder seedFile() {
    GltfBuilder builder = GltfBuilder::square();
    const auto png = encodePng(2, 2, 4, 8, std::vector<uint16_t>(16, 99));
    builder.set("/images/0/bufferView", builder.view(png))
        .set("/textures/0", R"({"source": 0, "sampler": 0})");
    builder.set("/samplers/0", R"({"wrapS": 33071, "magFilter": 9728})");
    builder.set("/materials/0", R"({"name": "m", "alphaMode": "MASK", "emissiveFactor": [1, 0, 1],
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.5},
        "normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1, "scale": [2, 2]}}},
        "extensions": {"KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2},
                       "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_sheen": {}}})");
    builder.set("/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}})");
    builder.set("/extensions/KHR_lights_punctual/lights/0",
                R"({"type": "spot", "intensity": 5, "spot": {}})");
    builder.set("/nodes/1", R"({"camera": 0, "children": [0, 2], "scale": [1, 2, -3]})");
    builder.set("/nodes/2", R"({"mesh": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}})");
    builder.set("/scenes/0/nodes", "[1]");
    const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(4, 12));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), points.data(), 4, 12));
    const uint32_t compressed = builder.view(std::as_bytes(std::span(bytes)));
    const std::string view = "/bufferViews/" + std::to_string(compressed);
    builder.set("/buffers/1/byteLength", "48");
    builder.set(view + "/extensions/EXT_meshopt_compression",
                R"({"buffer": 0, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"})");
    builder.set(view + "/extensions/EXT_meshopt_compression/byteLength", uint32_t(bytes.size()));
    builder.set(view + "/buffer", 1).set(view + "/byteLength", 48);
    builder.set(view + "/extensions/EXT_meshopt_compression/byteOffset", builder.offsetOf(compressed));
    builder.set(view + "/byteOffset", 0);
    const uint32_t positions = builder.accessorOf(compressed, "VEC3", 5126, 4);
    builder.set("/meshes/1/primitives/0/attributes/POSITION", positions)
        .set("/meshes/1/primitives/0/mode", 5);
    const std::vector<uint8_t> at{1, 2};
    const uint32_t sparse = builder.view(std::as_bytes(std::span(at)));
    builder.set("/accessors/0/sparse", R"({"count": 2, "indices": {"componentType": 5121, "bufferView": 0},
                                           "values": {"bufferView": 0}})");
    builder.set("/accessors/0/sparse/indices/bufferView", sparse);
    return builder;
}

GltfBuilder dracoFile(bool edgebreaker) {
    draco::TriangleSoupMeshBuilder soup;
    soup.Start(2);
    const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const glm::vec3 corners[2][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    for (uint32_t f = 0; f < 2; ++f)
        soup.SetAttributeValuesForFace(position, draco::FaceIndex(f), &corners[f][0].x, &corners[f][1].x,
                                       &corners[f][2].x);
    const auto mesh = soup.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                          : draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer out;
    if (!encoder.EncodeMeshToBuffer(*mesh, &out).ok())
        throw std::runtime_error("draco cannot write its seed");

    GltfBuilder builder = GltfBuilder::square();
    const uint32_t view = builder.view(std::as_bytes(std::span(out.data(), out.size())));
    const std::string primitive = "/meshes/0/primitives/0";
    const std::string extension = primitive + "/extensions/KHR_draco_mesh_compression";
    builder.set(extension + "/bufferView", view)
        .set(extension + "/attributes/POSITION", mesh->attribute(position)->unique_id());
    builder.set(primitive + "/attributes", R"({"POSITION": 0})").set(primitive + "/indices", 1);
    builder.set("/accessors", R"([{"type": "VEC3", "componentType": 5126, "count": 4},
        {"type": "SCALAR", "componentType": 5123, "count": 6}])");
    builder.set("/extensionsRequired", R"(["KHR_draco_mesh_compression"])");
    return builder;
}

}  // namespace tilefarm
