// The material extensions of Khronos, one function each. A texture that a factor of 0 makes unseen is
// not read.
#include <fmt/format.h>

#include <algorithm>

#include "worker/scene/material_reader.h"

namespace tilefarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAnyFloat = std::numeric_limits<float>::max();

void readIor(MaterialReader& reader, Material& m) {
    const JsonNode ior = reader.extension("KHR_materials_ior")["ior"];
    // 0 stands for "reflect as if it were infinite": F0 is the specular colour alone.
    m.ior = ior && ior.number() == 0 ? 0 : reader.clamped(ior, 1.5, 1, 1000);
}

void readSpecular(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_specular");
    m.specular = reader.factor(node["specularFactor"], 1);
    m.specularColor = reader.color(node["specularColorFactor"], glm::vec3(1), kAnyFloat);
    if (m.specular > 0) {
        m.specularTexture = reader.dataTexture(node["specularTexture"]);
        m.specularColorTexture = reader.colorTexture(node["specularColorTexture"]);
    }
}

void readClearcoat(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_clearcoat");
    m.clearcoat = reader.factor(node["clearcoatFactor"], 0);
    m.clearcoatRoughness = reader.factor(node["clearcoatRoughnessFactor"], 0);
    const JsonNode normal = node["clearcoatNormalTexture"];
    m.clearcoatNormalScale = reader.clamped(normal["scale"], 1, -kAnyFloat, kAnyFloat);
    if (m.clearcoat > 0) {
        m.clearcoatTexture = reader.dataTexture(node["clearcoatTexture"]);
        m.clearcoatRoughnessTexture = reader.dataTexture(node["clearcoatRoughnessTexture"]);
        m.clearcoatNormalTexture = reader.dataTexture(normal);
    }
}

void readSheen(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_sheen");
    m.sheenColor = reader.color(node["sheenColorFactor"], glm::vec3(0));
    m.sheenRoughness = reader.factor(node["sheenRoughnessFactor"], 0);
    if (m.sheenColor != glm::vec3(0)) {
        m.sheenColorTexture = reader.colorTexture(node["sheenColorTexture"]);
        m.sheenRoughnessTexture = reader.dataTexture(node["sheenRoughnessTexture"]);
    }
}

void readAnisotropy(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_anisotropy");
    m.anisotropy = reader.factor(node["anisotropyStrength"], 0);
    m.anisotropyRotation = reader.clamped(node["anisotropyRotation"], 0, -kAnyFloat, kAnyFloat);
    if (m.anisotropy > 0) {
        m.anisotropyTexture = reader.dataTexture(node["anisotropyTexture"]);
    }
}

void readIridescence(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_iridescence");
    m.iridescence = reader.factor(node["iridescenceFactor"], 0);
    m.iridescenceIor = reader.clamped(node["iridescenceIor"], 1.3, 1, 1000);
    m.iridescenceThicknessMinimum = reader.factor(node["iridescenceThicknessMinimum"], 100, kAnyFloat);
    m.iridescenceThicknessMaximum = reader.factor(node["iridescenceThicknessMaximum"], 400, kAnyFloat);
    if (m.iridescence > 0) {
        m.iridescenceTexture = reader.dataTexture(node["iridescenceTexture"]);
        m.iridescenceThicknessTexture = reader.dataTexture(node["iridescenceThicknessTexture"]);
    }
}

void readDispersion(MaterialReader& reader, Material& m) {
    m.dispersion = reader.factor(reader.extension("KHR_materials_dispersion")["dispersion"], 0, kAnyFloat);
}

void readTransmission(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_transmission");
    m.transmission = reader.factor(node["transmissionFactor"], 0);
    if (m.transmission > 0) {
        m.transmissionTexture = reader.dataTexture(node["transmissionTexture"]);
    }
}

void readDiffuseTransmission(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_diffuse_transmission");
    m.diffuseTransmission = reader.factor(node["diffuseTransmissionFactor"], 0);
    m.diffuseTransmissionColor = reader.color(node["diffuseTransmissionColorFactor"], glm::vec3(1));
    if (m.diffuseTransmission > 0) {
        m.diffuseTransmissionTexture = reader.dataTexture(node["diffuseTransmissionTexture"]);
        m.diffuseTransmissionColorTexture = reader.colorTexture(node["diffuseTransmissionColorTexture"]);
    }
}

void readVolume(MaterialReader& reader, Material& m) {
    const JsonNode node = reader.extension("KHR_materials_volume");
    m.thickness = reader.factor(node["thicknessFactor"], 0, kAnyFloat);
    m.attenuationColor = reader.color(node["attenuationColor"], glm::vec3(1));
    const JsonNode distance = node["attenuationDistance"];
    const double value = distance.numberOr(kInfinity);
    if (!(value > 0)) {
        distance.fail(fmt::format("must be greater than 0, is {}", value));
    }
    // A distance that a float rounds to 0 would divide by it.
    m.attenuationDistance = std::max(static_cast<float>(value), std::numeric_limits<float>::min());
    const bool entered = m.thickness > 0 && (m.transmission > 0 || m.diffuseTransmission > 0);
    if (node["thicknessTexture"] && entered) {
        reader.warn("thicknessTexture",
                    "light passes through the mesh itself, whose thickness counts and not the texture's");
    }
}

}  // namespace

void readMaterialExtensions(MaterialReader& reader, Material& material) {
    readIor(reader, material);
    readSpecular(reader, material);
    readClearcoat(reader, material);
    readSheen(reader, material);
    readAnisotropy(reader, material);
    readIridescence(reader, material);
    readDispersion(reader, material);
    readTransmission(reader, material);
    readDiffuseTransmission(reader, material);
    readVolume(reader, material);
}

}  // namespace tilefarm
