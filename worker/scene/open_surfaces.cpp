#include "worker/scene/open_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

/// Hole by area of the surface, above which it is open.
constexpr double kLargestHole = 1e-3;
/// Cells along the longest side of the box around all corners; what shares a cell is one corner. Corners on
/// either side of a cell's border leave a crack, which goes around no area.
constexpr double kCells = 0x1p20;

using Cell = std::array<int64_t, 3>;

struct CellHash {
    size_t operator()(const Cell& c) const {
        const uint64_t mixed = static_cast<uint64_t>(c[0]) * 0x9e3779b97f4a7c15u ^
                               static_cast<uint64_t>(c[1]) * 0xc2b2ae3d27d4eb4fu ^
                               static_cast<uint64_t>(c[2]) * 0x165667b19e3779f9u;
        return mixed ^ mixed >> 29;
    }
};

using Corners = std::array<uint32_t, 3>;
constexpr Corners kCollapsed{kNone, kNone, kNone};  // has neither edges nor area

/// One edge of one triangle.
struct Edge {
    uint32_t low, high;  // corners
    uint32_t triangle;
    bool ascends;  // the triangle runs from the low corner to the high one
    bool meets(const Edge& other) const { return low == other.low && high == other.high; }
    friend bool operator<(const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    }
};

/// Sets of numbers that are joined.
class Sets {
public:
    explicit Sets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    uint32_t of(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(uint32_t a, uint32_t b) { parent_[of(a)] = of(b); }

private:
    std::vector<uint32_t> parent_;
};

/// Triangles with welded corners, and which surfaces they make.
class Surfaces {
public:
    explicit Surfaces(std::span<const Mesh* const> meshes) {
        setCells(meshes);
        for (const Mesh* mesh : meshes)
            for (const glm::uvec3& t : mesh->triangles) triangles_.push_back(corners(*mesh, t));
        link(edges());
        follow();
    }

    std::vector<bool> open() {
        std::vector<double> area(triangles_.size());
        for (size_t t = 0; t < triangles_.size(); ++t) area[surface_[t]] += areaOf(triangles_[t]);
        std::vector<bool> holed(triangles_.size());
        for (const auto& [surface, hole] : holes())
            if (glm::length(hole) > kLargestHole * area[surface]) holed[surface] = true;
        std::vector<bool> result(triangles_.size());
        for (size_t t = 0; t < triangles_.size(); ++t) result[t] = holed[surface_[t]];
        return result;
    }

private:
    struct Link {
        uint32_t triangle;
        bool opposed;  // one of both faces the other side
    };
    struct Hole {
        uint32_t surface;
        glm::dvec3 area;
    };

    void setCells(std::span<const Mesh* const> meshes) {
        glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
        for (const Mesh* mesh : meshes)
            for (const glm::vec3& position : mesh->positions) {
                if (!isFinite(position)) continue;
                lower = glm::min(lower, glm::dvec3(position));
                upper = glm::max(upper, glm::dvec3(position));
            }
        const glm::dvec3 size = upper - lower;
        origin_ = lower;
        cellSize_ = std::max({size.x, size.y, size.z, double{std::numeric_limits<float>::min()}}) / kCells;
    }

    Corners corners(const Mesh& mesh, const glm::uvec3& t) {
        const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
        return isFinite(a + b + c) ? Corners{corner(a), corner(b), corner(c)} : kCollapsed;
    }

    uint32_t corner(const glm::vec3& position) {
        const glm::dvec3 place = glm::dvec3(position) - origin_, cell = glm::round(place / cellSize_);
        const auto [known, isNew] = corners_.try_emplace(
            {static_cast<int64_t>(cell.x), static_cast<int64_t>(cell.y), static_cast<int64_t>(cell.z)},
            static_cast<uint32_t>(places_.size()));
        if (isNew) places_.push_back(place);
        return known->second;
    }

    double areaOf(const Corners& c) const {
        if (c == kCollapsed) return 0;
        return 0.5 * glm::length(glm::cross(places_[c[1]] - places_[c[0]], places_[c[2]] - places_[c[0]]));
    }

    /// In order of their corners. Triangles that welding has collapsed have none.
    std::vector<Edge> edges() const {
        std::vector<Edge> result;
        result.reserve(3 * triangles_.size());
        for (uint32_t t = 0; t < triangles_.size(); ++t) {
            const auto [a, b, c] = triangles_[t];
            if (a == b || b == c || c == a) continue;
            for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
                result.push_back({std::min(from, to), std::max(from, to), t, from < to});
        }
        std::sort(result.begin(), result.end());
        return result;
    }

    void link(const std::vector<Edge>& edges) {
        links_.resize(triangles_.size());
        for (auto first = edges.begin(), end = first; first != edges.end(); first = end) {
            while (end != edges.end() && end->meets(*first)) ++end;
            if (end - first == 1) border_.push_back(*first);
            if (end - first != 2) continue;
            const Edge& other = first[1];
            const bool opposed = first->ascends == other.ascends;
            links_[first->triangle].push_back({other.triangle, opposed});
            links_[other.triangle].push_back({first->triangle, opposed});
        }
    }

    /// Numbers the surfaces by the first triangle of each.
    void follow() {
        surface_.assign(triangles_.size(), kNone);
        turned_.assign(triangles_.size(), false);
        for (uint32_t first = 0; first < triangles_.size(); ++first) {
            if (surface_[first] != kNone) continue;
            surface_[first] = first;
            for (std::vector<uint32_t> waiting{first}; !waiting.empty();) {
                const uint32_t t = waiting.back();
                waiting.pop_back();
                for (const Link& next : links_[t]) {
                    if (surface_[next.triangle] != kNone) continue;
                    surface_[next.triangle] = first;
                    turned_[next.triangle] = turned_[t] != next.opposed;
                    waiting.push_back(next.triangle);
                }
            }
        }
    }

    /// The closed lines of border edges, each with the vector area that it goes around.
    std::vector<Hole> holes() const {
        Sets lines(border_.size());
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> edgeAt;  // a corner of a surface
        for (uint32_t i = 0; i < border_.size(); ++i)
            for (const uint32_t corner : {border_[i].low, border_[i].high})
                lines.join(i, edgeAt.try_emplace({surface_[border_[i].triangle], corner}, i).first->second);
        std::map<uint32_t, Hole> result;
        for (uint32_t i = 0; i < border_.size(); ++i) {
            const Edge& edge = border_[i];
            const glm::dvec3 swept = 0.5 * glm::cross(places_[edge.low], places_[edge.high]);
            Hole& hole =
                result.try_emplace(lines.of(i), Hole{surface_[edge.triangle], glm::dvec3(0)}).first->second;
            hole.area += edge.ascends != turned_[edge.triangle] ? swept : -swept;
        }
        std::vector<Hole> list;
        for (const auto& [line, hole] : result) list.push_back(hole);
        return list;
    }

    glm::dvec3 origin_{0};
    double cellSize_ = 1;
    std::unordered_map<Cell, uint32_t, CellHash> corners_;
    std::vector<glm::dvec3> places_;  // of the corners
    std::vector<Corners> triangles_;
    std::vector<std::vector<Link>> links_;  // of each triangle, across edges of exactly two
    std::vector<Edge> border_;              // edges of one triangle
    std::vector<uint32_t> surface_;         // of each triangle: the first one of its surface
    std::vector<bool> turned_;              // it faces the other side than that first one
};

}  // namespace

std::vector<std::vector<bool>> openTriangles(std::span<const Mesh* const> meshes) {
    std::vector<std::vector<bool>> result(meshes.size());
    std::set<uint32_t> materials;
    for (const Mesh* mesh : meshes) materials.insert(mesh->material);
    // Triangles of the chosen meshes stay open only if they are among each other.
    const auto close = [&](const auto& chosen) {
        std::vector<const Mesh*> group;
        for (const Mesh* mesh : meshes)
            if (chosen(*mesh)) group.push_back(mesh);
        const std::vector<bool> open = Surfaces(group).open();
        auto next = open.begin();
        for (size_t i = 0; i < meshes.size(); ++i) {
            if (!chosen(*meshes[i])) continue;
            result[i].resize(meshes[i]->triangles.size(), true);
            for (size_t t = 0; t < result[i].size(); ++t, ++next) result[i][t] = result[i][t] && *next;
        }
    };
    close([](const Mesh&) { return true; });
    if (materials.size() < 2) return result;
    for (const uint32_t material : materials)
        close([&](const Mesh& mesh) { return mesh.material == material; });
    return result;
}

}  // namespace tilefarm
