#include "worker/scene/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "worker/scene/extensions.h"
#include "worker/scene/mesh_repair.h"
#include "worker/scene/open_surfaces.h"
#include "worker/scene/tangents.h"

namespace tilefarm {
namespace {

/// Vertices stored this far apart, relative to the size of their mesh, start to show as noise.
constexpr double kPrecisionWanted = 1e-5;

constexpr const char* kOpenInstead =
    "a surface of it is open (one plane, or a side is missing), so that it has no inside: thin-walled there, "
    "which refracts nothing and absorbs as one thickness does";

void keepTriangles(Mesh& mesh, const std::vector<bool>& marks, bool kept) {
    std::vector<glm::uvec3> triangles;
    for (size_t i = 0; i < marks.size(); ++i)
        if (marks[i] == kept) triangles.push_back(mesh.triangles[i]);
    mesh.triangles = std::move(triangles);
}

void checkMesh(const LoadContext& load, const JsonNode& mesh) {
    const JsonNode primitives = mesh["primitives"];
    for (size_t i = 0; i < primitives.size(); ++i) {
        checkPrimitive(load, primitives[i]);
    }
}

}  // namespace

std::vector<double> numbersOf(const JsonNode& array) {
    return array ? array.numbers(array.size()) : std::vector<double>{};
}

Meshes::Meshes(LoadContext& load)
    : load_(load), meshes_(load.file.root()["meshes"]), usedMaterials_(load.scene.materials.size(), false) {
    for (const Material& material : load.scene.materials) solid_.push_back(isSolid(material));
    for (size_t i = 0; i < meshes_.size(); ++i) {
        readIfSound(meshes_[i], [&] { checkMesh(load, meshes_[i]); });
    }
}

/// As long as a mesh may have to be deformed anew, it is kept as it was read.
const Meshes::Source& Meshes::sourceOf(uint32_t index) {
    const auto [entry, isNew] = sources_.try_emplace(index);
    Source& source = entry->second;
    if (!isNew) {
        return source;
    }
    checkMesh(load_, meshes_[index]);
    const JsonNode primitives = meshes_[index]["primitives"];
    for (size_t i = 0; i < primitives.size(); ++i) {
        warnOfNotRendered(load_, primitives[i]);
        if (std::optional<RawPrimitive> raw = readPrimitive(load_, primitives[i])) {
            warnOfPrecision(raw->mesh, primitives[i]);
            source.morphs |= !raw->targets.empty();
            source.parts.push_back({std::move(*raw), primitives[i]});
        }
    }
    separateOpen(source.parts);
    return source;
}

/// Splits primitives of solid materials into what encloses something and what does not. By what they are
/// before morph targets and joints move them, which tear nothing.
void Meshes::separateOpen(std::vector<Part>& parts) {
    const auto solid = [&](const Part& part) {
        const uint32_t material = part.raw.mesh.material;
        return solid_[material == kNone ? solid_.size() - 1 : material];
    };
    if (std::none_of(parts.begin(), parts.end(), solid)) return;
    std::vector<const Mesh*> meshes;
    for (const Part& part : parts) meshes.push_back(&part.raw.mesh);
    const std::vector<std::vector<bool>> open = openTriangles(meshes);
    std::vector<Part> result;
    for (size_t i = 0; i < parts.size(); ++i) {
        if (!solid(parts[i]) || std::find(open[i].begin(), open[i].end(), true) == open[i].end()) {
            result.push_back(std::move(parts[i]));
            continue;
        }
        Part thin = parts[i];
        thin.raw.mesh.open = true;
        keepTriangles(thin.raw.mesh, open[i], true);
        keepTriangles(parts[i].raw.mesh, open[i], false);
        load_.warn("KHR_materials_volume", thin.primitive, kOpenInstead);
        if (!parts[i].raw.mesh.triangles.empty()) result.push_back(std::move(parts[i]));
        result.push_back(std::move(thin));
    }
    parts = std::move(result);
}

const std::vector<uint32_t>& Meshes::load(uint32_t index, const std::vector<double>& weights) {
    if (const auto known = rigid_.find(index); known != rigid_.end()) {
        return known->second;
    }
    const Source& source = sourceOf(index);
    if (!source.morphs) {
        const auto entry = rigid_.emplace(index, addParts(index, {}, nullptr, slotsOfFile_)).first;
        const bool mayBeSkinned = std::any_of(source.parts.begin(), source.parts.end(),
                                              [](const Part& part) { return bool(part.raw.influences); });
        if (!mayBeSkinned) {
            sources_.erase(index);
        }
        return entry->second;
    }
    const std::vector<double> blend = weights.empty() ? numbersOf(meshes_[index]["weights"]) : weights;
    const auto [entry, isNew] = morphed_.try_emplace({index, blend});
    if (isNew) {
        entry->second = addParts(index, blend, nullptr, slotsOfPose_);
    }
    return entry->second;
}

std::vector<uint32_t> Meshes::loadSkinned(uint32_t index, const std::vector<double>& weights,
                                          const std::vector<glm::dmat4>& joints) {
    sourceOf(index);
    return addParts(index, weights.empty() ? numbersOf(meshes_[index]["weights"]) : weights, &joints,
                    slotsOfPose_);
}

void Meshes::beginPose() {
    for (const uint32_t slot : slotsOfPose_) {
        load_.scene.meshes[slot] = Mesh{};
    }
    freeSlots_.insert(freeSlots_.end(), slotsOfPose_.begin(), slotsOfPose_.end());
    slotsOfPose_.clear();
    morphed_.clear();
    degenerateOfPose_ = 0;
}

/// The primitives of a mesh, deformed, in slots of scene.meshes.
std::vector<uint32_t> Meshes::addParts(uint32_t index, const std::vector<double>& weights,
                                       const std::vector<glm::dmat4>* joints, std::vector<uint32_t>& slots) {
    std::vector<uint32_t> result;
    for (const Part& part : sources_.at(index).parts) {
        Mesh mesh = part.raw.mesh;
        blendTargets(mesh, part.raw.targets, weights);
        if (joints && part.raw.influences) {
            applySkin(mesh, part.raw.influences, *joints, part.primitive);
        }
        mesh.name = meshes_[index]["name"].textOr(fmt::format("meshes/{}", index));
        (&slots == &slotsOfPose_ ? degenerateOfPose_ : degenerateOfFile_) += finish(mesh);
        result.push_back(store(std::move(mesh)));
        slots.push_back(result.back());
    }
    return result;
}

uint32_t Meshes::store(Mesh mesh) {
    std::vector<Mesh>& meshes = load_.scene.meshes;
    if (freeSlots_.empty()) {
        meshes.push_back(std::move(mesh));
        return static_cast<uint32_t>(meshes.size() - 1);
    }
    const uint32_t slot = freeSlots_.back();
    freeSlots_.pop_back();
    meshes[slot] = std::move(mesh);
    return slot;
}

bool Meshes::isSkinned(uint32_t index) {
    const Source* source = rigid_.contains(index) && !sources_.contains(index) ? nullptr : &sourceOf(index);
    return source && std::any_of(source->parts.begin(), source->parts.end(),
                                 [](const Part& part) { return bool(part.raw.influences); });
}

/// Everything after reading: default material, repairs, tangents where a normal map or anisotropy wants them.
/// Gives the number of triangles left out.
uint64_t Meshes::finish(Mesh& mesh) {
    if (mesh.material == kNone) {
        mesh.material = static_cast<uint32_t>(load_.scene.materials.size() - 1);
    }
    use(mesh.material);
    const uint64_t dropped = dropDegenerateTriangles(mesh);
    repairNormals(mesh);
    repairSurface(mesh);
    const Material& material = load_.scene.materials[mesh.material];
    const TextureRef& normalTexture =
        material.normalTexture ? material.normalTexture : material.clearcoatNormalTexture;
    const bool wanted = normalTexture || material.anisotropy > 0;
    if (!wanted) {
        mesh.tangents.clear();
    } else if (mesh.normals.empty()) {
        mesh.tangents.clear();  // without normals, glTF has the file's tangents ignored
        makeFlat(mesh);
    }
    dropUnusedVertices(mesh);
    if (!mesh.tangents.empty()) {
        repairTangents(mesh);
    } else if (wanted) {
        // Without a texture that says otherwise the tangent follows u of the first set.
        generateTangents(mesh, normalTexture ? normalTexture : material.anisotropyTexture);
    }
    return dropped;
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
            fmt::format("its vertices are so far from the mesh's origin that float32 positions are "
                        "{:.2g} apart, in a mesh of size {:.2g}; a node's translation would keep them exact",
                        spacing, size));
    }
}

}  // namespace tilefarm
