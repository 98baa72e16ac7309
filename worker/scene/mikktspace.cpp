#include "worker/scene/mikktspace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "worker/scene/mesh_repair.h"

namespace tilefarm {
namespace {

constexpr int32_t kNoTriangle = -1;
constexpr int32_t kNoGroup = -1;

struct Vertex {
    std::array<float, 8> values;
    friend bool operator==(const Vertex&, const Vertex&) = default;
};

struct VertexHash {
    size_t operator()(const Vertex& vertex) const {
        uint64_t hash = 0xcbf29ce484222325u;
        for (float value : vertex.values) {
            // Adding 0 makes -0 hash like the 0 that it equals.
            hash = (hash ^ std::bit_cast<uint32_t>(value + 0.0f)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

struct Face {
    glm::uvec3 vertex{0};               // after welding
    glm::ivec3 neighbour{kNoTriangle};  // across the edge from corner k to corner k+1
    glm::ivec3 group{kNoGroup};         // of each corner
    glm::dvec3 tangent{0};              // direction of +u, unit length
    bool preserving = false;            // texture space is not mirrored
    bool anyGroup = true;               // texture coordinates give no direction: joins any group
};

struct CornerEdge {
    uint32_t low, high;  // vertices
    int32_t face;
    int corner;  // it starts at
};

class TangentBuilder {
public:
    TangentBuilder(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                   std::span<const glm::vec2> uvs, std::span<const glm::uvec3> triangles)
        : positions_(positions), normals_(normals), uvs_(uvs), faces_(triangles.size()) {
        weld(triangles);
        for (Face& face : faces_) {
            findDirection(face);
        }
        findNeighbours();
        buildGroups();
    }

    std::vector<glm::vec4> tangents() const {
        const std::vector<glm::dvec3> sums = sumGroups();
        std::vector<glm::vec4> result;
        result.reserve(faces_.size() * 3);
        for (const Face& face : faces_) {
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 sum =
                    face.group[k] == kNoGroup ? glm::dvec3(0) : sums[size_t(face.group[k])];
                const glm::dvec3 tangent = normalizeOrZero(sum);
                const bool none = tangent == glm::dvec3(0);
                result.emplace_back(none ? anyOrthogonal(normals_[face.vertex[k]]) : tangent,
                                    none || face.preserving ? 1.0f : -1.0f);
            }
        }
        return result;
    }

private:
    /// Corners with the same position, normal and texture coordinate become one vertex.
    void weld(std::span<const glm::uvec3> triangles) {
        std::unordered_map<Vertex, uint32_t, VertexHash> known;
        known.reserve(positions_.size());
        std::vector<uint32_t> first(positions_.size());
        for (uint32_t i = 0; i < positions_.size(); ++i) {
            const glm::vec3 p = positions_[i], n = normals_[i];
            const glm::vec2 t = uvs_[i];
            first[i] = known.try_emplace({{p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y}}, i).first->second;
        }
        for (size_t f = 0; f < triangles.size(); ++f) {
            faces_[f].vertex = {first[triangles[f].x], first[triangles[f].y], first[triangles[f].z]};
        }
    }

    void findDirection(Face& face) const {
        const glm::dvec3 e1 = position(face, 1) - position(face, 0),
                         e2 = position(face, 2) - position(face, 0);
        const glm::dvec2 d1 = uv(face, 1) - uv(face, 0), d2 = uv(face, 2) - uv(face, 0);
        const double area = d1.x * d2.y - d1.y * d2.x;
        face.preserving = area > 0;
        face.tangent = normalizeOrZero((e1 * d2.y - e2 * d1.y) * (area > 0 ? 1.0 : -1.0));
        face.anyGroup = area == 0 || face.tangent == glm::dvec3(0);
    }

    /// Two triangles are neighbours if they run along an edge in opposite directions.
    void findNeighbours() {
        std::vector<CornerEdge> edges;
        edges.reserve(faces_.size() * 3);
        for (size_t f = 0; f < faces_.size(); ++f) {
            for (int k = 0; k < 3; ++k) {
                const uint32_t a = faces_[f].vertex[k], b = faces_[f].vertex[(k + 1) % 3];
                edges.push_back({std::min(a, b), std::max(a, b), static_cast<int32_t>(f), k});
            }
        }
        std::sort(edges.begin(), edges.end(), [](const CornerEdge& a, const CornerEdge& b) {
            return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
        });
        // Along an edge, earlier triangles wait in turn for one that runs the other way.
        std::vector<const CornerEdge*> waiting;
        size_t served = 0;
        for (size_t i = 0; i < edges.size(); ++i) {
            const CornerEdge& edge = edges[i];
            if (i == 0 || edge.low != edges[i - 1].low || edge.high != edges[i - 1].high) {
                waiting.clear();
                served = 0;
            }
            if (served < waiting.size() && start(edge) != start(*waiting[served])) {
                const CornerEdge& other = *waiting[served++];
                faces_[size_t(edge.face)].neighbour[edge.corner] = other.face;
                faces_[size_t(other.face)].neighbour[other.corner] = edge.face;
            } else {
                waiting.push_back(&edge);
            }
        }
    }

    void buildGroups() {
        for (size_t f = 0; f < faces_.size(); ++f) {
            for (int k = 0; k < 3; ++k) {
                if (!faces_[f].anyGroup && faces_[f].group[k] == kNoGroup) {
                    floodGroup(static_cast<int32_t>(f), faces_[f].vertex[k], groupCount_++);
                }
            }
        }
    }

    /// Walks from triangle to triangle around one vertex as long as their orientation is the same.
    void floodGroup(int32_t first, uint32_t vertex, int32_t group) {
        const bool preserving = faces_[size_t(first)].preserving;
        std::vector<int32_t> open{first};
        while (!open.empty()) {
            Face& face = faces_[size_t(open.back())];
            open.pop_back();
            const int corner = face.vertex[0] == vertex ? 0 : face.vertex[1] == vertex ? 1 : 2;
            if (face.group[corner] != kNoGroup) {
                continue;
            }
            // The first group that a triangle without direction joins decides its orientation.
            if (face.anyGroup && face.group == glm::ivec3(kNoGroup)) {
                face.preserving = preserving;
            }
            if (face.preserving != preserving) {
                continue;
            }
            face.group[corner] = group;
            for (int edge : {corner, (corner + 2) % 3}) {
                if (face.neighbour[edge] != kNoTriangle) {
                    open.push_back(face.neighbour[edge]);
                }
            }
        }
    }

    /// Of the tangents in a group, each in the plane of the normal and weighted by the triangle's angle
    /// there.
    std::vector<glm::dvec3> sumGroups() const {
        std::vector<glm::dvec3> sums(size_t(groupCount_), glm::dvec3(0));
        for (const Face& face : faces_) {
            for (int k = 0; k < 3 && !face.anyGroup; ++k) {
                const glm::dvec3 normal(normals_[face.vertex[k]]);
                const auto inPlane = [&](glm::dvec3 v) {
                    return normalizeOrZero(v - normal * glm::dot(normal, v));
                };
                const glm::dvec3 before = inPlane(position(face, (k + 2) % 3) - position(face, k));
                const glm::dvec3 after = inPlane(position(face, (k + 1) % 3) - position(face, k));
                const double angle = std::acos(std::clamp(glm::dot(before, after), -1.0, 1.0));
                sums[size_t(face.group[k])] += inPlane(face.tangent) * angle;
            }
        }
        return sums;
    }

    uint32_t start(const CornerEdge& edge) const { return faces_[size_t(edge.face)].vertex[edge.corner]; }
    glm::dvec3 position(const Face& face, int corner) const { return positions_[face.vertex[corner]]; }
    glm::dvec2 uv(const Face& face, int corner) const { return uvs_[face.vertex[corner]]; }

    std::span<const glm::vec3> positions_, normals_;
    std::span<const glm::vec2> uvs_;
    std::vector<Face> faces_;
    int32_t groupCount_ = 0;
};

}  // namespace

glm::dvec3 anyOrthogonal(glm::dvec3 n) {
    const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return normalizeOrZero(axis - n * glm::dot(n, axis));
}

std::vector<glm::vec4> mikkTangents(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                    std::span<const glm::vec2> uvs, std::span<const glm::uvec3> triangles) {
    return TangentBuilder(positions, normals, uvs, triangles).tangents();
}

}  // namespace tilefarm
