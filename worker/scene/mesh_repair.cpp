#include "worker/scene/mesh_repair.h"

#include <algorithm>
#include <cmath>

#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

template <typename Visit>
void forEachAttribute(Mesh& mesh, Visit visit) {
    visit(mesh.positions);
    visit(mesh.normals);
    visit(mesh.tangents);
    visit(mesh.uv0);
    visit(mesh.uv1);
    visit(mesh.colors);
}

template <typename Vector>
void replaceNotFinite(std::vector<Vector>& values, float replacement) {
    for (Vector& value : values) {
        for (int c = 0; c < Vector::length(); ++c) {
            value[c] = std::isfinite(value[c]) ? value[c] : replacement;
        }
    }
}

}  // namespace

glm::dvec3 normalizeOrZero(glm::dvec3 v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0) || !std::isfinite(largest) || !std::isfinite(v.x + v.y + v.z)) {
        return glm::dvec3(0);
    }
    // Scaled first: the squares of very large or small components leave the range of double.
    return glm::normalize(v / largest);
}

glm::dvec3 geometricNormal(const Mesh& mesh, glm::uvec3 triangle) {
    const glm::dvec3 a(mesh.positions[triangle.x]), b(mesh.positions[triangle.y]),
        c(mesh.positions[triangle.z]);
    return normalizeOrZero(glm::cross(b - a, c - a));
}

uint64_t dropDegenerateTriangles(Mesh& mesh) {
    const auto degenerate = [&](glm::uvec3 t) {
        return !isFinite(mesh.positions[t.x]) || !isFinite(mesh.positions[t.y]) ||
               !isFinite(mesh.positions[t.z]) || geometricNormal(mesh, t) == glm::dvec3(0);
    };
    return std::erase_if(mesh.triangles, degenerate);
}

void repairNormals(Mesh& mesh) {
    std::vector<bool> usable(mesh.normals.size());
    for (size_t i = 0; i < mesh.normals.size(); ++i) {
        const glm::dvec3 normal = normalizeOrZero(mesh.normals[i]);
        usable[i] = normal != glm::dvec3(0);
        mesh.normals[i] = normal;
    }
    if (std::find(usable.begin(), usable.end(), true) == usable.end()) {
        mesh.normals.clear();
        return;
    }
    if (std::find(usable.begin(), usable.end(), false) == usable.end()) {
        return;
    }
    for (glm::uvec3& triangle : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            if (!usable[triangle[k]]) {
                const glm::vec3 normal = geometricNormal(mesh, triangle);
                triangle[k] = duplicateVertex(mesh, triangle[k]);
                mesh.normals[triangle[k]] = normal;
                usable.push_back(true);
            }
        }
    }
}

void makeFlat(Mesh& mesh) {
    const auto expand = [&](auto& attribute) {
        if (attribute.empty()) {
            return;
        }
        std::remove_reference_t<decltype(attribute)> expanded;
        expanded.reserve(mesh.triangles.size() * 3);
        for (glm::uvec3 t : mesh.triangles) {
            expanded.insert(expanded.end(), {attribute[t.x], attribute[t.y], attribute[t.z]});
        }
        attribute = std::move(expanded);
    };
    forEachAttribute(mesh, expand);
    mesh.normals.resize(mesh.positions.size());
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto first = static_cast<uint32_t>(i * 3);
        mesh.triangles[i] = {first, first + 1, first + 2};
        std::fill_n(mesh.normals.begin() + first, 3, glm::vec3(geometricNormal(mesh, mesh.triangles[i])));
    }
}

void repairSurface(Mesh& mesh) {
    replaceNotFinite(mesh.uv0, 0);
    replaceNotFinite(mesh.uv1, 0);
    replaceNotFinite(mesh.colors, 1);
}

void dropUnusedVertices(Mesh& mesh) {
    std::vector<uint32_t> moved(mesh.positions.size(), kNone);
    for (glm::uvec3 t : mesh.triangles) {
        moved[t.x] = moved[t.y] = moved[t.z] = 0;
    }
    uint32_t used = 0;
    for (uint32_t& index : moved) {
        index = index == kNone ? kNone : used++;
    }
    if (used == moved.size()) {
        return;
    }
    forEachAttribute(mesh, [&](auto& attribute) {
        if (attribute.empty()) {
            return;
        }
        for (size_t i = 0; i < moved.size(); ++i) {
            if (moved[i] != kNone) {
                attribute[moved[i]] = attribute[i];
            }
        }
        attribute.resize(used);
    });
    for (glm::uvec3& t : mesh.triangles) {
        t = {moved[t.x], moved[t.y], moved[t.z]};
    }
}

uint32_t duplicateVertex(Mesh& mesh, uint32_t vertex) {
    forEachAttribute(mesh, [vertex](auto& attribute) {
        if (!attribute.empty()) {
            const auto copy = attribute[vertex];
            attribute.push_back(copy);
        }
    });
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

}  // namespace tilefarm
