#include "worker/scene/skins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "worker/scene/mesh_repair.h"

namespace tilefarm {
namespace {

Skin parseSkin(LoadContext& load, const JsonNode& node) {
    const size_t nodeCount = load.file.root()["nodes"].size();
    const JsonNode joints = node["joints"];
    Skin skin;
    for (size_t i = 0; i < joints.size(); ++i) {
        skin.joints.push_back(joints[i].index(nodeCount, "/nodes"));
    }
    if (skin.joints.empty()) {
        node["joints"].fail("has no joint");
    }
    skin.inverseBind.assign(skin.joints.size(), glm::dmat4(1));
    if (const JsonNode matrices = node["inverseBindMatrices"]) {
        const auto given = load.accessors.mat4s(matrices.index(load.accessors.count(), "/accessors"));
        if (given.size() < skin.joints.size()) {
            matrices.fail(fmt::format("has {} matrices for {} joints", given.size(), skin.joints.size()));
        }
        for (size_t i = 0; i < skin.joints.size(); ++i) {
            for (int k = 0; k < 16; ++k) {
                if (!std::isfinite(given[i][k / 4][k % 4])) {
                    matrices.fail(fmt::format("matrix {} is not finite", i));
                }
            }
            skin.inverseBind[i] = glm::dmat4(given[i]);
        }
    }
    return skin;
}

/// Cofactors: the inverse transpose up to a factor, also of a singular matrix; flipped back where it mirrors.
glm::dmat3 normalMatrix(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

/// A negative weight as small as this is what is left of a difference or a quantisation.
constexpr double kRounding = 1e-4;

class Blender {
public:
    Blender(const Influences& influences, const std::vector<glm::dmat4>& joints, const JsonNode& primitive)
        : influences_(influences), joints_(joints), primitive_(primitive) {}

    glm::dmat4 matrixOf(size_t vertex) const {
        glm::dmat4 sum(0);
        double weights = 0;
        for (int set = 0; set < 2; ++set) {
            if (influences_.joints[set].empty()) {
                continue;
            }
            for (int i = 0; i < 4; ++i) {
                const double weight = weightOf(set, vertex, i);
                if (weight > 0) {  // joints that weigh nothing may be anything
                    sum += weight * joints_[jointOf(set, vertex, i)];
                    weights += weight;
                }
            }
        }
        return weights > 0 ? sum * (1 / weights) : joints_[firstNamed(vertex)];
    }

private:
    double weightOf(int set, size_t vertex, int i) const {
        const double weight = influences_.weights[set][vertex][i];
        if (!(weight >= -kRounding) || !std::isfinite(weight)) {
            fail(fmt::format("WEIGHTS_{}", set), vertex, fmt::format("has a weight of {}", weight));
        }
        if (weight < 0) {
            primitive_["attributes"][fmt::format("WEIGHTS_{}", set)].tolerate(
                fmt::format("vertex {} has a weight of {}", vertex, weight), "rendered with 0");
        }
        return std::max(weight, 0.0);
    }

    /// Of a vertex without any weight, as three.js does it.
    size_t firstNamed(size_t vertex) const {
        const JsonNode attributes = primitive_["attributes"];
        attributes["WEIGHTS_0"].warn("skins", fmt::format("vertex {} has no weight at all: such vertices "
                                                          "follow the first joint that they name",
                                                          vertex));
        const double joint = influences_.joints[0][vertex][0];
        return joint >= 0 && joint < static_cast<double>(joints_.size()) ? static_cast<size_t>(joint) : 0;
    }

    size_t jointOf(int set, size_t vertex, int i) const {
        const double joint = influences_.joints[set][vertex][i];
        if (!(joint >= 0 && joint < static_cast<double>(joints_.size()))) {
            fail(fmt::format("JOINTS_{}", set), vertex,
                 fmt::format("follows joint {} of a skin of {}", joint, joints_.size()));
        }
        return static_cast<size_t>(joint);
    }

    [[noreturn]] void fail(const std::string& attribute, size_t vertex, const std::string& fault) const {
        primitive_["attributes"][attribute].fail(fmt::format("vertex {} {}", vertex, fault));
    }

    const Influences& influences_;
    const std::vector<glm::dmat4>& joints_;
    const JsonNode& primitive_;
};

}  // namespace

PartList<Skin> parseSkins(LoadContext& load) {
    const JsonNode nodes = load.file.root()["skins"];
    PartList<Skin> skins;
    for (size_t i = 0; i < nodes.size(); ++i) {
        skins.add(nodes[i], [&] { return parseSkin(load, nodes[i]); });
    }
    return skins;
}

void applySkin(Mesh& mesh, const Influences& influences, const std::vector<glm::dmat4>& jointMatrices,
               const JsonNode& primitive) {
    const Blender blender(influences, jointMatrices, primitive);
    std::vector<bool> mirrored(mesh.positions.size());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dmat4 m = blender.matrixOf(i);
        const glm::dmat3 linear(m);
        mirrored[i] = glm::determinant(linear) < 0;
        mesh.positions[i] = glm::dvec3(m * glm::dvec4(mesh.positions[i], 1));
        if (!mesh.normals.empty()) {
            mesh.normals[i] = normalizeOrZero(normalMatrix(linear) * glm::dvec3(mesh.normals[i]));
        }
        if (!mesh.tangents.empty()) {
            const glm::vec4 t = mesh.tangents[i];
            mesh.tangents[i] =
                glm::vec4(glm::vec3(normalizeOrZero(linear * glm::dvec3(t))), mirrored[i] ? -t.w : t.w);
        }
    }
    for (glm::uvec3& t : mesh.triangles) {
        if (mirrored[t.x] && mirrored[t.y] && mirrored[t.z]) {
            std::swap(t.y, t.z);
        }
    }
}

}  // namespace tilefarm
