#include "tests/fuzz/scene_seeds.h"

#include <meshoptimizer.h>

#include <glm/gtc/type_ptr.hpp>

#include "tests/fuzz/seed_file.h"

namespace tilefarm {
namespace {

using Floats = std::vector<float>;

const std::string kPrimitive = "/meshes/0/primitives/0/";

// An animation of one channel; its target in the glTF way or by a pointer.
void animate(GltfBuilder& builder, const std::string& target, const char* interpolation, const Floats& times,
             const Floats& values, const char* type) {
    const std::string animation = "/animations/" + std::to_string(builder.size("/animations"));
    builder.set(animation + "/samplers/0/input", builder.accessor(times, "SCALAR"))
        .set(animation + "/samplers/0/output", builder.accessor(values, type))
        .set(animation + "/samplers/0/interpolation", '"' + std::string(interpolation) + '"')
        .set(animation + "/channels/0", R"({"sampler": 0})")
        .set(animation + "/channels/0/target", target);
}

std::string pointer(const std::string& text) {
    return R"({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": ")" + text + "\"}}}";
}

void addImage(GltfBuilder& builder, uint32_t bits = 8) {
    const auto image = std::to_string(builder.size("/images"));
    const auto png =
        encodePng(2, 2, bits == 16 ? 3 : 4, bits, std::vector<uint16_t>(bits == 16 ? 12 : 16, 77));
    builder.set("/images/" + image + "/bufferView", builder.view(png));
    builder.set("/textures/" + image, "{\"source\": " + image + "}");
}

// ---- Geometry

GltfBuilder interleaved() {
    GltfBuilder builder = GltfBuilder::triangle();
    const Floats vertices{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 1};
    const uint32_t view = builder.view(std::as_bytes(std::span(vertices)), 32);
    const auto attribute = [&](const char* name, const char* type, uint32_t offset) {
        const uint32_t index = builder.accessorOf(view, type, 5126, 3);
        builder.set("/accessors/" + std::to_string(index) + "/byteOffset", offset);
        builder.set(kPrimitive + "attributes/" + name, index);
    };
    attribute("POSITION", "VEC3", 0);
    attribute("NORMAL", "VEC3", 12);
    attribute("TEXCOORD_0", "VEC2", 24);
    return builder;
}

GltfBuilder everyAttribute() {
    GltfBuilder builder = GltfBuilder::square();
    const std::string attributes = kPrimitive + "attributes/";
    builder.set(attributes + "TANGENT", builder.accessor(std::vector<glm::vec4>(4, {1, 0, 0, 1})));
    builder.set(
        attributes + "TEXCOORD_1",
        builder.accessor(std::vector<uint16_t>{0, 0, 65535, 0, 65535, 65535, 0, 65535}, "VEC2", true));
    builder.set(attributes + "COLOR_0",
                builder.accessor(std::vector<uint8_t>{255, 0, 0, 255, 0, 255, 0, 9, 1, 2, 3, 4, 5, 6, 7, 8},
                                 "VEC4", true));
    addImage(builder);
    builder.set("/materials/0",
                R"({"normalTexture": {"index": 0, "texCoord": 1, "scale": 2}, "alphaMode": "BLEND",
        "occlusionTexture": {"index": 0, "strength": 0.5}, "emissiveTexture": {"index": 0}})");
    return builder;
}

GltfBuilder quantized() {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::vector<int16_t> corners{0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0};
    const uint32_t view = builder.view(std::as_bytes(std::span(corners)), 8);
    builder.set(kPrimitive + "attributes/POSITION", builder.accessorOf(view, "VEC3", 5122, 3, true));
    const std::vector<int8_t> normals{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
    const uint32_t small = builder.view(std::as_bytes(std::span(normals)), 4);
    builder.set(kPrimitive + "attributes/NORMAL", builder.accessorOf(small, "VEC3", 5120, 3, true));
    builder.set("/extensionsRequired", R"(["KHR_mesh_quantization"])");
    return builder;
}

GltfBuilder everyMode() {
    GltfBuilder builder = GltfBuilder::square();
    const uint32_t indices = builder.accessor(std::vector<uint8_t>{0, 1, 2, 3, 0, 2}, "SCALAR");
    for (uint32_t mode = 0; mode < 7; ++mode) {
        const std::string primitive = "/meshes/0/primitives/" + std::to_string(mode);
        builder.set(primitive + "/attributes/POSITION", 0).set(primitive + "/mode", mode);
        if (mode % 2 == 0) builder.set(primitive + "/indices", indices);
    }
    return builder;
}

GltfBuilder sparse() {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::vector<uint16_t> at{0, 2};
    const std::vector<glm::vec3> values{{0, 0, 1}, {0, 2, 0}};
    const auto indices = std::to_string(builder.view(std::as_bytes(std::span(at))));
    const auto data = std::to_string(builder.view(std::as_bytes(std::span(values))));
    builder.set("/accessors/1", R"({"type": "VEC3", "componentType": 5126, "count": 3})");
    builder.set("/accessors/1/sparse", R"({"count": 2, "indices": {"componentType": 5123, "bufferView": )" +
                                           indices + R"(}, "values": {"bufferView": )" + data + "}}");
    builder.set(kPrimitive + "attributes/POSITION", 1);
    return builder;
}

// Bytes that one of meshoptimizer's encoders wrote become a view.
uint32_t compressedView(GltfBuilder& builder, const std::vector<unsigned char>& bytes, uint32_t stride,
                        uint32_t count, const std::string& mode, const std::string& filter) {
    const uint32_t index = builder.view(std::as_bytes(std::span(bytes)));
    const std::string view = "/bufferViews/" + std::to_string(index),
                      extension = view + "/extensions/EXT_meshopt_compression";
    builder.set(extension + "/buffer", 0)
        .set(extension + "/byteStride", stride)
        .set(extension + "/count", count);
    builder.set(extension + "/byteOffset", builder.offsetOf(index))
        .set(extension + "/byteLength", uint32_t(bytes.size()));
    builder.set(extension + "/mode", '"' + mode + '"').set(extension + "/filter", '"' + filter + '"');
    builder.set("/buffers/1/byteLength", "4096");
    builder.set(view + "/buffer", 1).set(view + "/byteOffset", 0).set(view + "/byteLength", stride * count);
    return index;
}

GltfBuilder meshopt() {
    GltfBuilder builder = GltfBuilder::square();
    const std::vector<uint32_t> triangles{0, 1, 2, 0, 2, 3};
    std::vector<unsigned char> bytes(meshopt_encodeIndexBufferBound(6, 4));
    bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), triangles.data(), 6));
    const uint32_t list =
        builder.accessorOf(compressedView(builder, bytes, 4, 6, "TRIANGLES", "NONE"), "SCALAR", 5125, 6);
    builder.set(kPrimitive + "indices", list);
    bytes.resize(meshopt_encodeIndexSequenceBound(6, 4));
    bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), triangles.data(), 6));
    const uint32_t sequence =
        builder.accessorOf(compressedView(builder, bytes, 4, 6, "INDICES", "NONE"), "SCALAR", 5125, 6);
    builder.set("/meshes/0/primitives/1/attributes/POSITION", 0)
        .set("/meshes/0/primitives/1/indices", sequence);
    const auto vertices = [&](const auto& values, uint32_t stride, const char* filter) {
        bytes.resize(meshopt_encodeVertexBufferBound(4, stride));
        bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), 4, stride));
        return compressedView(builder, bytes, stride, 4, "ATTRIBUTES", filter);
    };
    const uint32_t normals = vertices(
        std::vector<int8_t>{0, 0, 127, 0, 9, 9, 127, 0, 1, 2, 127, 0, 0, 0, 127, 0}, 4, "OCTAHEDRAL");
    builder.set(kPrimitive + "attributes/NORMAL", builder.accessorOf(normals, "VEC3", 5120, 4, true));
    const uint32_t turns = vertices(std::vector<int16_t>(16, 3), 8, "QUATERNION");
    const uint32_t exponential = vertices(std::vector<uint32_t>(12, 0x01000005), 12, "EXPONENTIAL");
    builder.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/ROTATION",
                builder.accessorOf(turns, "VEC4", 5122, 4, true));
    builder.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION",
                builder.accessorOf(exponential, "VEC3", 5126, 4));
    return builder;
}

GltfBuilder instanced() {
    GltfBuilder builder = GltfBuilder::square();
    const std::string attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/";
    builder.set(attributes + "TRANSLATION", builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {2, 0, 0}}));
    builder.set(attributes + "ROTATION",
                builder.accessor(std::vector<glm::vec4>{{0, 0, 0, 1}, {1, 0, 0, 0}}));
    builder.set(attributes + "SCALE", builder.accessor(std::vector<glm::vec3>{{1, 1, 1}, {1, -2, 1}}));
    return builder;
}

// ---- Time

GltfBuilder skinned() {
    GltfBuilder builder = GltfBuilder::square();
    const std::string attributes = kPrimitive + "attributes/";
    builder.set(
        attributes + "JOINTS_0",
        builder.accessor(std::vector<uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
    builder.set(attributes + "WEIGHTS_0", builder.accessor(std::vector<uint8_t>{255, 0, 0, 0, 128, 127, 0, 0,
                                                                                255, 0, 0, 0, 200, 55, 0, 0},
                                                           "VEC4", true));
    builder.set(attributes + "JOINTS_1", builder.accessor(std::vector<uint16_t>(16, 0), "VEC4"));
    builder.set(attributes + "WEIGHTS_1", builder.accessor(std::vector<glm::vec4>(4, {0.5f, 0, 0, 0})));
    const glm::mat4 unit(1);
    Floats matrices(glm::value_ptr(unit), glm::value_ptr(unit) + 16);
    matrices.insert(matrices.end(), glm::value_ptr(unit), glm::value_ptr(unit) + 16);
    builder.set("/skins/0/inverseBindMatrices",
                builder.accessorOf(builder.view(std::as_bytes(std::span(matrices))), "MAT4", 5126, 2));
    builder.set("/skins/0/joints", "[1, 2]").set("/nodes/0/skin", 0);
    builder.set("/nodes/1", R"({"name": "root", "children": [2]})")
        .set("/nodes/2", R"({"translation": [0, 1, 0]})");
    builder.set("/scenes/0/nodes", "[0, 1]");
    animate(builder, R"({"node": 2, "path": "rotation"})", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0},
            "VEC4");
    return builder;
}

GltfBuilder morphed() {
    GltfBuilder builder = GltfBuilder::square();
    builder.set(kPrimitive + "targets/0/POSITION", builder.accessor(std::vector<glm::vec3>(4, {0, 0, 1})))
        .set(kPrimitive + "targets/0/NORMAL", builder.accessor(std::vector<glm::vec3>(4, {0, 1, 0})))
        .set(kPrimitive + "targets/1/POSITION", builder.accessor(std::vector<glm::vec3>(4, {1, 0, 0})))
        .set(kPrimitive + "targets/1/TEXCOORD_0", 2);
    builder.set("/meshes/0/weights", "[0.5, 0]").set("/nodes/0/weights", "[0, 1]");
    animate(builder, R"({"node": 0, "path": "weights"})", "CUBICSPLINE", {0, 1},
            {0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0}, "SCALAR");
    animate(builder, pointer("/meshes/0/weights"), "STEP", {0.5f}, {1, 1}, "SCALAR");
    return builder;
}

GltfBuilder animated() {
    GltfBuilder builder = GltfBuilder::square();
    addImage(builder);
    builder.set("/materials/0", R"({"name": "m", "alphaMode": "MASK",
        "normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0, 0]}}}})");
    builder.set("/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}})");
    builder.set("/cameras/1",
                R"({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 2, "znear": 0, "zfar": 9}})");
    builder.set("/extensions/KHR_lights_punctual/lights/0",
                R"({"type": "spot", "spot": {"outerConeAngle": 0.6}})");
    builder.set("/nodes/1", R"({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}})");
    builder.set(
        "/nodes/2",
        R"({"camera": 1, "children": [1], "extensions": {"KHR_node_visibility": {"visible": true}}})");
    builder.set("/scenes/0/nodes", "[0, 2]");
    animate(builder, R"({"node": 0, "path": "translation"})", "LINEAR", {0, 1, 2}, Floats(9, 1), "VEC3");
    animate(builder, R"({"node": 0, "path": "scale"})", "STEP", {0, 1}, Floats(6, 2), "VEC3");
    animate(builder, R"({"node": 0, "path": "rotation"})", "CUBICSPLINE", {0, 1}, Floats(24, 0.5f), "VEC4");
    animate(builder, pointer("/cameras/0/perspective/yfov"), "LINEAR", {0, 1}, {0.5f, 1}, "SCALAR");
    animate(builder, pointer("/cameras/1/orthographic/xmag"), "LINEAR", {0, 1}, {0.5f, 1}, "SCALAR");
    animate(builder, pointer("/materials/0/pbrMetallicRoughness/baseColorFactor"), "LINEAR", {0, 1},
            Floats(8, 0.5f), "VEC4");
    animate(builder, pointer("/materials/0/normalTexture/extensions/KHR_texture_transform/offset"), "LINEAR",
            {0, 1}, Floats(4, 0.5f), "VEC2");
    animate(builder, pointer("/materials/0/extensions/KHR_materials_ior/ior"), "LINEAR", {0, 1}, {1.2f, 2},
            "SCALAR");
    animate(builder, pointer("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle"), "LINEAR",
            {0, 1}, {0.5f, 1}, "SCALAR");
    animate(builder, pointer("/nodes/2/extensions/KHR_node_visibility/visible"), "STEP", {0, 1}, {1, 0},
            "SCALAR");
    return builder;
}

// ---- Materials and lights

GltfBuilder everyMaterial() {
    GltfBuilder builder = GltfBuilder::square();
    addImage(builder);
    const char* const extensions[] = {
        R"("KHR_materials_ior": {"ior": 1.4}, "KHR_materials_emissive_strength": {"emissiveStrength": 5})",
        R"("KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 2], "specularTexture": {"index": 0}, "specularColorTexture": {"index": 0}})",
        R"("KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.5, "clearcoatTexture": {"index": 0}, "clearcoatRoughnessTexture": {"index": 0}, "clearcoatNormalTexture": {"index": 0, "scale": 0.5}})",
        R"("KHR_materials_sheen": {"sheenColorFactor": [1, 1, 0], "sheenRoughnessFactor": 0.5, "sheenColorTexture": {"index": 0}, "sheenRoughnessTexture": {"index": 0}})",
        R"("KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": {"index": 0}})",
        R"("KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessMinimum": 50, "iridescenceThicknessMaximum": 500, "iridescenceTexture": {"index": 0}, "iridescenceThicknessTexture": {"index": 0}})",
        R"("KHR_materials_dispersion": {"dispersion": 1}, "KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": 0}}, "KHR_materials_volume": {"thicknessFactor": 1, "thicknessTexture": {"index": 0}, "attenuationColor": [0.5, 1, 1], "attenuationDistance": 2})",
        R"("KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [1, 0, 1], "diffuseTransmissionTexture": {"index": 0}, "diffuseTransmissionColorTexture": {"index": 0}})",
        R"("KHR_materials_unlit": {}, "KHR_materials_volume_scatter": {})",
        R"("TILEFARM_materials": {"conductor": "gold", "roughness": 0.2, "microfacets": "beckmann", "fresnel": "schlick", "orenNayarSigma": 0.3, "sheen": 1, "subsurface": 0.5, "disneyDiffuse": true, "clearcoatGloss": 0.5, "specularTint": 1})",
    };
    for (size_t i = 0; i < std::size(extensions); ++i) {
        builder.set("/materials/" + std::to_string(i),
                    "{\"extensions\": {" + std::string(extensions[i]) + "}}");
        builder.set("/meshes/0/primitives/" + std::to_string(i),
                    R"({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}})");
        builder.set("/meshes/0/primitives/" + std::to_string(i) + "/material", uint32_t(i));
    }
    builder.set("/extensionsUsed", R"(["KHR_materials_ior", "KHR_materials_unlit", "EXT_unheard_of"])");
    return builder;
}

GltfBuilder specularGlossiness() {
    GltfBuilder builder = GltfBuilder::square();
    addImage(builder);
    addImage(builder, 16);
    builder.set(
        "/materials/0/extensions/KHR_materials_pbrSpecularGlossiness",
        R"({"diffuseFactor": [1, 0.5, 1, 1], "specularFactor": [0.2, 0.2, 0.2], "glossinessFactor": 0.7,
                           "diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}})");
    return builder;
}

GltfBuilder variants() {
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/materials/1", R"({"name": "other", "doubleSided": true, "emissiveFactor": [1, 1, 1]})");
    builder.set("/extensions/KHR_materials_variants/variants", R"([{"name": "day"}, {"name": "night"}])");
    builder.set(kPrimitive + "extensions/KHR_materials_variants/mappings",
                R"([{"material": 1, "variants": [0]}, {"material": 0, "variants": [1]}])");
    return builder;
}

GltfBuilder textures() {
    GltfBuilder builder = GltfBuilder::square();
    addImage(builder, 16);
    const auto png = encodePng(2, 1, 3, 8, std::vector<uint16_t>(6, 200));
    builder.set("/images/1", R"({"name": "embedded", "mimeType": "image/png"})")
        .set("/images/1/uri", "\"data:image/png;base64," + base64(png) + '"');
    builder.set("/images/2", R"({"uri": "a.png"})");
    builder.set("/samplers/0", R"({"wrapS": 33648, "wrapT": 33071, "magFilter": 9728, "minFilter": 9987})");
    builder.set("/textures/1",
                R"({"source": 1, "sampler": 0, "extensions": {"EXT_texture_webp": {"source": 0}}})");
    builder.set("/textures/2", R"({"source": 2})");
    builder.set("/materials/0", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "metallicRoughnessTexture": {"index": 1, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1,
        "scale": [2, 2], "texCoord": 0}}}}, "emissiveTexture": {"index": 2}, "emissiveFactor": [1, 1, 1]})");
    return builder;
}

GltfBuilder lights() {
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/extensions/KHR_lights_punctual/lights", R"([
        {"type": "point", "intensity": 5, "range": 9, "color": [1, 0.5, 0]},
        {"type": "directional", "extensions": {"TILEFARM_lights": {"angularDiameter": 0.5}}},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}},
        {"type": "point", "extensions": {"TILEFARM_lights": {"radius": 0.1}}},
        {"type": "spot", "spot": {}, "extensions": {"TILEFARM_lights": {"width": 1, "height": 2, "twoSided": true}}}])");
    for (uint32_t i = 0; i < 5; ++i) {
        const std::string node = "/nodes/" + std::to_string(i + 1);
        builder.set(node + "/extensions/KHR_lights_punctual/light", i).set(node + "/scale", "[1, 2, 3]");
        builder.set("/nodes/0/children/" + std::to_string(i), i + 1);
    }
    return builder;
}

GltfBuilder shapes() {
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/materials/0", R"({"emissiveFactor": [1, 1, 1], "doubleSided": true})");
    builder.set("/extensions/KHR_implicit_shapes/shapes", R"([
        {"type": "sphere", "sphere": {"radius": 0.5}}, {"type": "box", "box": {"size": [1, 2, 3]}},
        {"type": "cylinder", "cylinder": {"height": 1, "radiusBottom": 0.4, "radiusTop": 0}},
        {"type": "capsule", "capsule": {"height": 0.6, "radiusBottom": 0.35, "radiusTop": 0.15}},
        {"type": "plane", "plane": {"sizeX": 14}}])");
    builder.set("/extensions/TILEFARM_shapes/surfaces", R"([
        {"rectangle": {"size": [3, 1.2]}}, {"disk": {"radius": 0.5}}, {"field": {"torus": {"radius": 0.4, "tube": 0.1}}},
        {"field": {"smooth": 0.2, "union": [{"sphere": {"radius": 0.3}, "translation": [0.2, 0, 0]},
            {"difference": [{"box": {"size": [1, 1, 1], "rounding": 0.1}}, {"cone": {"height": 1, "radiusTop": 0.1}}]},
            {"intersection": [{"sphere": {}, "rotation": [0, 1, 0, 0]}, {"mandelbulb": {"power": 8, "iterations": 4}}]}]}}])");
    for (uint32_t i = 0; i < 9; ++i) {
        const std::string node = "/nodes/" + std::to_string(i + 1),
                          shown = node + "/extensions/TILEFARM_shapes/";
        builder.set(shown + (i < 5 ? "shape" : "surface"), i < 5 ? i : i - 5).set(shown + "material", 0);
        builder.set(node + "/translation", "[" + std::to_string(i) + ", 0, 0]");
        builder.set("/scenes/0/nodes/" + std::to_string(i + 1), i + 1);
    }
    return builder;
}

GltfBuilder nodes() {
    GltfBuilder builder = GltfBuilder::square();
    builder.set("/nodes/0/matrix", "[1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 4, 5, 6, 1]");
    builder.set(
        "/nodes/1",
        R"({"children": [0, 2], "rotation": [0, 0.6, 0, 0.8], "translation": [1e6, 0, 0], "extras": {"a": [1]}})");
    builder.set(
        "/nodes/2",
        R"({"mesh": 0, "scale": [-1, 1e-3, 1], "extensions": {"KHR_node_visibility": {"visible": false}}})");
    builder.set("/scenes", R"([{"nodes": [1]}, {"name": "other", "nodes": [2]}])").set("/scene", 0);
    builder.set("/extensions/KHR_xmp_json_ld", R"({"packets": [{"dc:title": "x"}]})");
    return builder;
}

}  // namespace

std::vector<std::pair<std::string, GltfBuilder>> sceneSeeds() {
    std::vector<std::pair<std::string, GltfBuilder>> seeds;
    const auto add = [&](const char* name, GltfBuilder builder) {
        seeds.emplace_back(name, std::move(builder));
    };
    add("mixed", seedFile());
    add("sequential", dracoFile(false));
    add("edgebreaker", dracoFile(true));
    add("interleaved", interleaved());
    add("attributes", everyAttribute());
    add("quantized", quantized());
    add("modes", everyMode());
    add("sparse", sparse());
    add("meshopt", meshopt());
    add("instanced", instanced());
    add("skinned", skinned());
    add("morphed", morphed());
    add("animated", animated());
    add("materials", everyMaterial());
    add("glossiness", specularGlossiness());
    add("variants", variants());
    add("textures", textures());
    add("lights", lights());
    add("shapes", shapes());
    add("nodes", nodes());
    return seeds;
}

std::vector<std::filesystem::path> writeSceneSeeds(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths;
    auto seeds = sceneSeeds();
    for (auto& [name, builder] : seeds) {
        // Which of the two hardly matters to the loader past its first bytes; the mutator turns one into the
        // other.
        const bool glb = paths.size() % 2 == 0;
        paths.push_back(glb ? builder.writeGlb(folder, name + ".glb")
                            : builder.writeEmbedded(folder, name + ".gltf"));
    }
    return paths;
}

}  // namespace tilefarm
