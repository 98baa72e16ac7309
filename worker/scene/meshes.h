#pragma once

#include <map>
#include <utility>
#include <vector>

#include "worker/scene/load_context.h"

namespace tilefarm {

/// The meshes of a glTF file. Construction checks all of them; those that nodes ask for are read into
/// scene.meshes, one per primitive, once for each set of morph weights.
class Meshes {
public:
    /// The materials must be in load.scene, the default one last.
    explicit Meshes(LoadContext& load);

    /// Where the primitives of mesh `index` are in scene.meshes. Without `weights` its own ones hold.
    const std::vector<uint32_t>& load(uint32_t index, const std::vector<double>& weights);
    /// Whether a mesh that was loaded has the material.
    const std::vector<bool>& usedMaterials() const { return usedMaterials_; }
    size_t count() const { return meshes_.size(); }

private:
    void finish(Mesh& mesh);
    void warnOfPrecision(const Mesh& mesh, const JsonNode& primitive);

    LoadContext& load_;
    JsonNode meshes_;
    std::vector<bool> usedMaterials_;
    std::map<std::pair<uint32_t, std::vector<double>>, std::vector<uint32_t>> loaded_;
};

/// An array of numbers, empty where it is missing.
std::vector<double> numbersOf(const JsonNode& array);

}  // namespace tilefarm
