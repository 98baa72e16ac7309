#include "worker/scene/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "worker/scene/extensions.h"
#include "worker/scene/mesh_repair.h"
#include "worker/scene/primitive.h"
#include "worker/scene/tangents.h"

namespace tilefarm {
namespace {

/// Vertices stored this far apart, relative to the size of their mesh, start to show as noise.
constexpr double kPrecisionWanted = 1e-5;

}  // namespace

std::vector<double> numbersOf(const JsonNode& array) {
    return array ? array.numbers(array.size()) : std::vector<double>{};
}

Meshes::Meshes(LoadContext& load)
    : load_(load), meshes_(load.file.root()["meshes"]), usedMaterials_(load.scene.materials.size(), false) {
    for (size_t i = 0; i < meshes_.size(); ++i) {
        const JsonNode primitives = meshes_[i]["primitives"];
        for (size_t p = 0; p < primitives.size(); ++p) {
            checkPrimitive(load, primitives[p]);
        }
    }
}

const std::vector<uint32_t>& Meshes::load(uint32_t index, const std::vector<double>& weights) {
    const JsonNode node = meshes_[index];
    const std::vector<double> blend = weights.empty() ? numbersOf(node["weights"]) : weights;
    const auto [entry, isNew] = loaded_.try_emplace({index, blend});
    if (!isNew) {
        return entry->second;
    }
    const JsonNode primitives = node["primitives"];
    for (size_t i = 0; i < primitives.size(); ++i) {
        if (primitives[i]["targets"].size() > 0) {
            load_.warn("morph targets", node, "rendered with its default weights");
        }
        warnOfNotRendered(load_, primitives[i]);
        std::optional<Mesh> mesh = readPrimitive(load_, primitives[i], blend);
        if (!mesh) {
            continue;
        }
        mesh->name = node["name"].textOr(fmt::format("meshes/{}", index));
        finish(*mesh);
        warnOfPrecision(*mesh, primitives[i]);
        entry->second.push_back(static_cast<uint32_t>(load_.scene.meshes.size()));
        load_.scene.meshes.push_back(std::move(*mesh));
    }
    return entry->second;
}

/// Everything after reading: default material, repairs, tangents where a normal map wants them.
void Meshes::finish(Mesh& mesh) {
    if (mesh.material == kNone) {
        mesh.material = static_cast<uint32_t>(load_.scene.materials.size() - 1);
    }
    usedMaterials_[mesh.material] = true;
    load_.scene.degenerateTriangles += dropDegenerateTriangles(mesh);
    repairNormals(mesh);
    repairSurface(mesh);
    const Material& material = load_.scene.materials[mesh.material];
    const TextureRef& normalTexture =
        material.normalTexture ? material.normalTexture : material.clearcoatNormalTexture;
    if (!normalTexture) {
        mesh.tangents.clear();
    } else if (mesh.normals.empty()) {
        mesh.tangents.clear();  // without normals, glTF has the file's tangents ignored
        makeFlat(mesh);
    }
    dropUnusedVertices(mesh);
    if (!mesh.tangents.empty()) {
        repairTangents(mesh);
    } else if (normalTexture) {
        generateTangents(mesh, normalTexture);
    }
}

void Meshes::warnOfPrecision(const Mesh& mesh, const JsonNode& primitive) {
    glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    for (glm::vec3 position : mesh.positions) {
        lower = glm::min(lower, glm::dvec3(position));
        upper = glm::max(upper, glm::dvec3(position));
    }
    const glm::dvec3 farthest = glm::max(glm::abs(lower), glm::abs(upper));
    const double spacing =
        std::max({farthest.x, farthest.y, farthest.z}) * std::numeric_limits<float>::epsilon();
    const double size = glm::length(upper - lower);
    if (!mesh.positions.empty() && spacing > size * kPrecisionWanted) {
        load_.warn(
            "precision loss", primitive,
            fmt::format(
                "its vertices are so far from their origin that they are {:.2g} apart at best, in a mesh "
                "of {:.2g}; a node's translation would keep them exact",
                spacing, size));
    }
}

}  // namespace tilefarm
