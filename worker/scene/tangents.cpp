#include "worker/scene/tangents.h"

#include "worker/scene/mesh_repair.h"
#include "worker/scene/mikktspace.h"

namespace tilefarm {
namespace {

std::vector<glm::vec2> readUvs(const Mesh& mesh, const TextureRef& texture) {
    const std::vector<glm::vec2>& given = texture.uvSet == 0 ? mesh.uv0 : mesh.uv1;
    std::vector<glm::vec2> uvs(mesh.positions.size(), glm::vec2(0));
    for (size_t i = 0; i < given.size(); ++i) {
        const glm::vec2 uv = texture.transform * glm::vec3(given[i], 1);
        uvs[i] = {uv.x, -uv.y};
    }
    return uvs;
}

/// Gives vertices their tangents, and a copy to corners that need another one than their vertex has.
class VertexSplitter {
public:
    explicit VertexSplitter(Mesh& mesh) : mesh_(mesh), next_(mesh.positions.size(), kNone) {
        mesh.tangents.assign(mesh.positions.size(), glm::vec4(0));
    }

    uint32_t vertexWith(uint32_t vertex, glm::vec4 tangent) {
        if (mesh_.tangents[vertex] == glm::vec4(0)) {
            mesh_.tangents[vertex] = tangent;
            return vertex;
        }
        // Copies form a chain behind their original. A mesh where many do not match is a fault of the mesh
        // and must not make this quadratic.
        constexpr int maxSteps = 16;
        uint32_t candidate = vertex;
        for (int step = 0; step < maxSteps && candidate != kNone; ++step) {
            if (mesh_.tangents[candidate] == tangent) {
                return candidate;
            }
            candidate = next_[candidate];
        }
        const uint32_t copy = duplicateVertex(mesh_, vertex);
        mesh_.tangents[copy] = tangent;
        next_.push_back(next_[vertex]);
        next_[vertex] = copy;
        return copy;
    }

private:
    Mesh& mesh_;
    std::vector<uint32_t> next_;
};

}  // namespace

void generateTangents(Mesh& mesh, const TextureRef& normalTexture) {
    const std::vector<glm::vec4> corners =
        mikkTangents(mesh.positions, mesh.normals, readUvs(mesh, normalTexture), mesh.triangles);
    VertexSplitter splitter(mesh);
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            mesh.triangles[i][k] = splitter.vertexWith(mesh.triangles[i][k], corners[i * 3 + size_t(k)]);
        }
    }
}

void repairTangents(Mesh& mesh) {
    for (size_t i = 0; i < mesh.tangents.size(); ++i) {
        const glm::dvec3 normal(mesh.normals[i]);
        const glm::dvec3 given = normalizeOrZero(glm::dvec3(mesh.tangents[i]));
        const glm::dvec3 tangent = normalizeOrZero(given - normal * glm::dot(normal, given));
        mesh.tangents[i] = glm::vec4(tangent == glm::dvec3(0) ? anyOrthogonal(normal) : tangent,
                                     mesh.tangents[i].w < 0 ? -1.0f : 1.0f);
    }
}

}  // namespace tilefarm
