#include "worker/scene/primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "worker/scene/draco_mesh.h"
#include "worker/scene/triangulate.h"
#include "worker/scene/variants.h"

namespace tilefarm {
namespace {

/// What is read of a vertex.
constexpr std::string_view kAttributes[] = {"POSITION", "NORMAL",   "TANGENT",  "TEXCOORD_0", "TEXCOORD_1",
                                            "COLOR_0",  "JOINTS_0", "JOINTS_1", "WEIGHTS_0",  "WEIGHTS_1"};

PrimitiveMode modeOf(const JsonNode& primitive) {
    return static_cast<PrimitiveMode>(primitive["mode"].integerOr(4, 6));
}

/// Reads the attributes of one primitive, wherever they are.
class AttributeReader {
public:
    AttributeReader(LoadContext& load, const JsonNode& primitive)
        : load_(load), attributes_(primitive["attributes"]) {
        if (const JsonNode draco = primitive["extensions"]["KHR_draco_mesh_compression"]) {
            const uint32_t view = draco["bufferView"].index(load.views.count(), "/bufferViews");
            draco_ = std::make_unique<DracoMesh>(load.views.bytes(view), draco);
            compressed_ = draco["attributes"];
        }
    }

    const DracoMesh* draco() const { return draco_.get(); }

    /// Empty where the primitive has no such attribute. `absent` is for components that it lacks.
    template <typename Vector>
    std::vector<Vector> read(const char* name, float absent = 0) {
        const JsonNode node = attributes_[name];
        if (!node) {
            return {};
        }
        const uint32_t index = node.index(load_.accessors.count(), "/accessors");
        return draco_ && compressed_[name] ? fromDraco<Vector>(name, index, absent)
                                           : fromAccessor<Vector>(index, absent);
    }

private:
    template <typename Vector>
    std::vector<Vector> fromAccessor(uint32_t index, float absent) {
        if constexpr (Vector::length() == 2) {
            return load_.accessors.vec2s(index);
        } else if constexpr (Vector::length() == 3) {
            return load_.accessors.vec3s(index);
        } else {
            return load_.accessors.vec4s(index, absent);
        }
    }

    template <typename Vector>
    std::vector<Vector> fromDraco(const char* name, uint32_t index, float absent) {
        const Accessor& accessor = load_.accessors[index];
        const uint32_t wanted = Vector::length(), given = accessor.components;
        if (given != wanted && !(wanted == 4 && given == 3)) {
            attributes_[name].fail(fmt::format("must have {} components, has {}", wanted, given));
        }
        const std::vector<float> values = draco_->attribute(name, given, accessor.normalized);
        std::vector<Vector> result(values.size() / given, Vector(absent));
        for (size_t i = 0; i < result.size(); ++i) {
            std::memcpy(&result[i], values.data() + i * given, given * sizeof(float));
        }
        return result;
    }

    LoadContext& load_;
    JsonNode attributes_;
    std::unique_ptr<DracoMesh> draco_;
    JsonNode compressed_ = attributes_;
};

void readAttributes(Mesh& mesh, AttributeReader& reader) {
    mesh.positions = reader.read<glm::vec3>("POSITION");
    mesh.normals = reader.read<glm::vec3>("NORMAL");
    mesh.tangents = reader.read<glm::vec4>("TANGENT");
    mesh.uv0 = reader.read<glm::vec2>("TEXCOORD_0");
    mesh.uv1 = reader.read<glm::vec2>("TEXCOORD_1");
    mesh.colors = reader.read<glm::vec4>("COLOR_0", 1);
}

void checkLengths(const Mesh& mesh, const JsonNode& attributes) {
    const auto check = [&](const char* name, size_t length) {
        if (length != 0 && length != mesh.positions.size()) {
            attributes[name].fail(
                fmt::format("has {} elements, but POSITION has {}", length, mesh.positions.size()));
        }
    };
    check("NORMAL", mesh.normals.size());
    check("TANGENT", mesh.tangents.size());
    check("TEXCOORD_0", mesh.uv0.size());
    check("TEXCOORD_1", mesh.uv1.size());
    check("COLOR_0", mesh.colors.size());
}

uint32_t restartValue(ComponentType type) {
    return type == ComponentType::u8 ? 0xffu : type == ComponentType::u16 ? 0xffffu : 0xffffffffu;
}

std::vector<uint32_t> readIndices(LoadContext& load, const JsonNode& primitive, const AttributeReader& reader,
                                  size_t vertexCount) {
    std::vector<uint32_t> indices;
    const JsonNode node = primitive["indices"];
    if (reader.draco()) {
        indices = reader.draco()->indices();
    } else if (node) {
        const uint32_t accessor = node.index(load.accessors.count(), "/accessors");
        indices = load.accessors.integers(accessor);
        const auto restart =
            std::find(indices.begin(), indices.end(), restartValue(load.accessors[accessor].type));
        if (restart != indices.end()) {
            node.fail(fmt::format("element {} is {}, a primitive restart value, which glTF forbids",
                                  restart - indices.begin(), *restart));
        }
    } else {
        indices.resize(vertexCount);
        std::iota(indices.begin(), indices.end(), 0u);
    }
    const auto outside =
        std::find_if(indices.begin(), indices.end(), [&](uint32_t i) { return i >= vertexCount; });
    if (outside != indices.end()) {
        node.fail(fmt::format("element {} refers to vertex {}, but there are only {}",
                              outside - indices.begin(), *outside, vertexCount));
    }
    return indices;
}

/// The deltas of one target for an attribute that the mesh has; empty where the target leaves it alone.
std::vector<glm::vec3> readDeltas(LoadContext& load, const JsonNode& target, const char* name, size_t count) {
    const JsonNode node = target[name];
    if (!node || count == 0) {
        return {};
    }
    std::vector<glm::vec3> deltas = load.accessors.vec3s(node.index(load.accessors.count(), "/accessors"));
    if (deltas.size() != count) {
        node.fail(fmt::format("has {} elements, but the mesh has {}", deltas.size(), count));
    }
    return deltas;
}

std::vector<MorphTarget> readTargets(LoadContext& load, const JsonNode& targets, const Mesh& mesh) {
    std::vector<MorphTarget> result(targets.size());
    for (size_t i = 0; i < targets.size(); ++i) {
        result[i].positions = readDeltas(load, targets[i], "POSITION", mesh.positions.size());
        result[i].normals = readDeltas(load, targets[i], "NORMAL", mesh.normals.size());
        result[i].tangents = readDeltas(load, targets[i], "TANGENT", mesh.tangents.size());
        for (const std::string& name : targets[i].keys()) {
            if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") {
                load.warn("morph target " + name, targets[i], "left as it is in the mesh");
            }
        }
    }
    return result;
}

Influences readInfluences(AttributeReader& reader, const JsonNode& attributes, size_t count) {
    constexpr const char* kJoints[] = {"JOINTS_0", "JOINTS_1"};
    constexpr const char* kWeights[] = {"WEIGHTS_0", "WEIGHTS_1"};
    Influences result;
    for (int set = 0; set < 2; ++set) {
        result.joints[set] = reader.read<glm::vec4>(kJoints[set]);
        result.weights[set] = reader.read<glm::vec4>(kWeights[set]);
        for (const auto& [values, name] :
             {std::pair{&result.joints[set], kJoints[set]}, std::pair{&result.weights[set], kWeights[set]}}) {
            const bool wanted = !result.joints[set].empty() || !result.weights[set].empty();
            if (wanted && values->size() != count) {
                (attributes[name] ? attributes[name] : attributes)
                    .fail(
                        fmt::format("{} has {} elements, but POSITION has {}", name, values->size(), count));
            }
        }
    }
    return result;
}

template <typename Vector>
void addWeighted(std::vector<Vector>& values, const std::vector<glm::vec3>& deltas, double weight) {
    for (size_t i = 0; i < deltas.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            values[i][c] = static_cast<float>(double{values[i][c]} + weight * double{deltas[i][c]});
        }
    }
}

const char* nameOf(PrimitiveMode mode) {
    switch (mode) {
        case PrimitiveMode::points: return "points";
        case PrimitiveMode::lines: return "lines";
        case PrimitiveMode::lineLoop: return "a line loop";
        case PrimitiveMode::lineStrip: return "a line strip";
        default: return "triangles";
    }
}

}  // namespace

void checkPrimitive(const LoadContext& load, const JsonNode& primitive) {
    const size_t accessors = load.accessors.count();
    modeOf(primitive);
    const JsonNode attributes = primitive["attributes"];
    for (const std::string& name : attributes.keys()) {
        const bool isRead =
            std::find(std::begin(kAttributes), std::end(kAttributes), name) != std::end(kAttributes);
        const auto check = [&] { attributes[name].index(accessors, "/accessors"); };
        isRead ? check() : static_cast<void>(readIfSound(attributes[name], check));
    }
    if (const JsonNode indices = primitive["indices"]) {
        indices.index(accessors, "/accessors");
    }
    if (const JsonNode material = primitive["material"]) {
        material.index(load.file.root()["materials"].size(), "/materials");
    }
    checkMappings(load.file.root(), primitive);
    const JsonNode targets = primitive["targets"];
    for (size_t i = 0; i < targets.size(); ++i) {
        const JsonNode target = targets[i];
        for (const std::string& name : target.keys()) {
            target[name].index(accessors, "/accessors");
        }
    }
}

std::optional<RawPrimitive> readPrimitive(LoadContext& load, const JsonNode& primitive) {
    const PrimitiveMode mode = modeOf(primitive);
    if (!makesTriangles(mode)) {
        load.warn(nameOf(mode), primitive, "left out: only triangles are rendered");
        return std::nullopt;
    }
    if (!primitive["attributes"]["POSITION"]) {
        load.warn("POSITION", primitive, "left out: it has no positions");
        return std::nullopt;
    }
    AttributeReader reader(load, primitive);
    RawPrimitive raw;
    Mesh& mesh = raw.mesh;
    readAttributes(mesh, reader);
    checkLengths(mesh, primitive["attributes"]);
    raw.targets = readTargets(load, primitive["targets"], mesh);
    raw.influences = readInfluences(reader, primitive["attributes"], mesh.positions.size());
    const std::vector<uint32_t> indices = readIndices(load, primitive, reader, mesh.positions.size());
    // The Draco decoder gives lists whatever was encoded.
    mesh.triangles = triangulate(reader.draco() ? PrimitiveMode::triangles : mode, indices);
    mesh.material = materialOf(load, primitive);
    return raw;
}

void blendTargets(Mesh& mesh, const std::vector<MorphTarget>& targets, const std::vector<double>& weights) {
    for (size_t i = 0; i < std::min(targets.size(), weights.size()); ++i) {
        if (weights[i] != 0) {
            addWeighted(mesh.positions, targets[i].positions, weights[i]);
            addWeighted(mesh.normals, targets[i].normals, weights[i]);
            addWeighted(mesh.tangents, targets[i].tangents, weights[i]);
        }
    }
}

}  // namespace tilefarm
