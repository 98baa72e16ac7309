#pragma once

#include <map>
#include <utility>
#include <vector>

#include "worker/scene/primitive.h"

namespace tilefarm {

/// The meshes of a glTF file. Construction checks all of them (a fault is a warning until a node asks for
/// the mesh); those that nodes ask for are read into
/// scene.meshes, one per primitive, once for each set of morph weights and for each use with a skin.
class Meshes {
public:
    /// The materials must be in load.scene, as they are at rest, the default one last. Where one of them is
    /// solid then, surfaces that enclose nothing become meshes of their own, marked open.
    explicit Meshes(LoadContext& load);

    /// Where the primitives of mesh `index` are in scene.meshes. Without `weights` its own ones hold.
    const std::vector<uint32_t>& load(uint32_t index, const std::vector<double>& weights);
    /// Likewise, moved along with joints: a matrix for each of the skin's. Primitives without JOINTS_0 stay.
    std::vector<uint32_t> loadSkinned(uint32_t index, const std::vector<double>& weights,
                                      const std::vector<glm::dmat4>& joints);
    /// Whether some primitive of the mesh has joints.
    bool isSkinned(uint32_t index);
    /// Frees the places in scene.meshes of what was morphed or skinned; the rest stays where it is.
    void beginPose();

    /// Something that is no mesh has the material.
    void use(uint32_t material) {
        load_.requireMaterial(material);
        usedMaterials_[material] = true;
    }
    /// Whether a mesh that was loaded has the material.
    const std::vector<bool>& usedMaterials() const { return usedMaterials_; }
    size_t count() const { return meshes_.size(); }
    /// Triangles left out of the meshes that are in the scene now.
    uint64_t degenerateTriangles() const { return degenerateOfFile_ + degenerateOfPose_; }

private:
    struct Part {
        RawPrimitive raw;
        JsonNode primitive;
    };
    struct Source {
        std::vector<Part> parts;
        bool morphs = false;
    };
    const Source& sourceOf(uint32_t index);
    std::vector<uint32_t> addParts(uint32_t index, const std::vector<double>& weights,
                                   const std::vector<glm::dmat4>* joints, std::vector<uint32_t>& slots);
    void separateOpen(std::vector<Part>& parts);
    uint32_t store(Mesh mesh);
    uint64_t finish(Mesh& mesh);
    void warnOfPrecision(const Mesh& mesh, const JsonNode& primitive);

    LoadContext& load_;
    JsonNode meshes_;
    std::vector<bool> usedMaterials_;
    std::vector<bool> solid_;                          // materials at rest
    std::map<uint32_t, Source> sources_;               // what may be deformed anew
    std::map<uint32_t, std::vector<uint32_t>> rigid_;  // what never is
    std::map<std::pair<uint32_t, std::vector<double>>, std::vector<uint32_t>> morphed_;
    std::vector<uint32_t> slotsOfFile_, slotsOfPose_, freeSlots_;
    uint64_t degenerateOfFile_ = 0, degenerateOfPose_ = 0;
};

/// An array of numbers, empty where it is missing.
std::vector<double> numbersOf(const JsonNode& array);

}  // namespace tilefarm
