#include "tests/shader/lobe_histogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "shaders/gpu_types.h"
#include "tests/numerics/statistics.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr int kRadial = 20, kAround = 12;
constexpr size_t kCells = size_t{kRadial} * kAround;
/// Slope that one facet in α / 1e5 exceeds, as seen along the surface.
constexpr double kSteepest = 1e5;
/// Of the cells around: floats are a lattice along the axes, as coarse as 2 % of α = 1e-3 at 89.9 degrees,
/// and no border between cells may lie on its lines.
constexpr double kTurn = 0.2;
/// Points per side of a cell that the border of what light reaches runs through.
constexpr int kFine = 24;

bool isThin(const ProbeMaterial& m) {
    return (static_cast<uint32_t>(m.flags) & gpu::MATERIAL_THIN) != 0;
}

/// Index of the far side over that of wo's side, for what passes the interface.
double etaOf(const ProbeMaterial& m) {
    if (isThin(m) || m.transmission == 0) return 1;
    const double ior = m.ior == 0 ? 1.5 : double{m.ior};
    return m.frontFace != 0 ? ior : 1 / ior;
}

struct Direction {
    glm::dvec3 wi;
    double solidAngle;  // per unit of the square
};

/// A part of the sphere of directions on the unit square.
class Chart {
public:
    enum class Kind { reflected, thin, refracted, rest };

    /// `most`: the largest slope of half vectors.
    Chart(Kind kind, const glm::dvec3& wo, const glm::dvec2& alpha, double eta, double most)
        : kind_(kind),
          wo_(wo),
          alpha_(alpha),
          eta_(eta),
          range_(std::log1p(most / alpha.x), std::log1p(most / alpha.y)) {}

    std::optional<Direction> at(double s, double t) const {
        const double phi = 2 * pi * t + kTurn;
        if (kind_ == Kind::rest) {
            const double r = std::sqrt(1 - s * s);
            return Direction{{r * std::cos(phi), r * std::sin(phi), -s}, 2 * pi};
        }
        const glm::dvec2 radii = radiiAt(s), turn(std::cos(phi), std::sin(phi));
        const glm::dvec3 slopes(radii * turn, 1);
        const double length = glm::length(slopes);
        const glm::dvec3 h = slopes / length;
        const glm::dvec2 grows = (radii + alpha_) * range_;  // per s
        const double area = grows.x * radii.y * turn.x * turn.x + grows.y * radii.x * turn.y * turn.y;
        const double normals = 2 * pi * area / (length * length * length);
        const double cosine = glm::dot(wo_, h);
        if (cosine <= 0) return {};
        if (kind_ == Kind::refracted) {
            const double sinSquared = (1 - cosine * cosine) / (eta_ * eta_);
            if (sinSquared >= 1) return {};
            const double beyond = std::sqrt(1 - sinSquared);
            const glm::dvec3 wi = -wo_ / eta_ + (cosine / eta_ - beyond) * h;
            if (wi.z >= 0) return {};
            const double sum = cosine / eta_ - beyond;
            return Direction{wi, normals * sum * sum / beyond};
        }
        glm::dvec3 wi = 2 * cosine * h - wo_;
        if (wi.z <= 0) return {};
        if (kind_ == Kind::thin) wi.z = -wi.z;
        return Direction{wi, normals * 4 * cosine};
    }

    std::optional<size_t> cellOf(glm::dvec3 wi) const {
        if (wi.z == 0 || (wi.z > 0) != (kind_ == Kind::reflected)) return {};
        double s = -wi.z;
        glm::dvec2 axis(wi);
        if (kind_ != Kind::rest) {
            if (kind_ == Kind::thin) wi.z = -wi.z;
            glm::dvec3 h = kind_ == Kind::refracted ? wo_ + eta_ * wi : wo_ + wi;
            h /= h.z;  // on the side of +z
            if (kind_ == Kind::refracted && !(glm::dot(wo_, h) > 0 && glm::dot(wi, h) < 0)) return {};
            s = radialOf(glm::dvec2(h));
            axis = glm::dvec2(h) / radiiAt(std::max(s, 1e-12));
        }
        double t = (std::atan2(axis.y, axis.x) - kTurn) / (2 * pi);
        t -= std::floor(t);
        return static_cast<size_t>(std::min(int(s * kRadial), kRadial - 1) * kAround +
                                   std::min(int(t * kAround), kAround - 1));
    }

private:
    /// Slopes along the axes: they start as α does and end the same.
    glm::dvec2 radiiAt(double s) const {
        return alpha_ * glm::dvec2(std::expm1(range_.x * s), std::expm1(range_.y * s));
    }
    double radialOf(const glm::dvec2& slopes) const {
        if (alpha_.x == alpha_.y) return std::log1p(glm::length(slopes) / alpha_.x) / range_.x;
        if (!(glm::length(slopes / radiiAt(1)) < 1)) return 1;
        double low = 0, high = 1;
        for (int i = 0; i < 30; ++i) {
            const double s = (low + high) / 2;
            (glm::length(slopes / radiiAt(s)) < 1 ? high : low) = s;
        }
        return low;
    }

    Kind kind_;
    glm::dvec3 wo_;
    glm::dvec2 alpha_;
    double eta_;
    glm::dvec2 range_;
};

/// The smoothest facets of a material set the scale.
glm::dvec2 scaleOf(const ProbeMaterial& m) {
    constexpr double least = ALPHA_DELTA;
    glm::dvec2 alpha(std::max<double>(m.alphaT < 0 ? m.alpha : m.alphaT, least),
                     std::max<double>(m.alpha, least));
    // Phong's are as round as they can be.
    if ((static_cast<uint32_t>(m.flags) & gpu::MATERIAL_PHONG) != 0)
        alpha = glm::dvec2(std::sqrt(0.5 * glm::dot(alpha, alpha)));
    if (m.clearcoat > 0) alpha = glm::min(alpha, glm::dvec2(std::max<double>(m.clearcoatAlpha, least)));
    return alpha;
}

/// A partition of the sphere but for what reflection cannot reach: each direction is in the first that has
/// it.
std::vector<Chart> chartsOf(const ProbeMaterial& m, const glm::dvec3& wo) {
    const glm::dvec2 alpha = scaleOf(m);
    using Kind = Chart::Kind;
    // Of the half vector of two directions above the surface, at most.
    const double most = (1 + std::sqrt(1 - wo.z * wo.z)) / wo.z;
    std::vector<Chart> charts{{Kind::reflected, wo, alpha, 1, most}};
    if (isThin(m) || m.transmission == 0) {
        charts.emplace_back(Kind::thin, wo, alpha, 1, most);
    } else {
        charts.emplace_back(Kind::refracted, wo, alpha, etaOf(m), kSteepest);
        charts.emplace_back(Kind::rest, wo, alpha, 1, 1);
    }
    return charts;
}

/// Points of a unit cell and their weights.
using Rule = std::vector<glm::dvec3>;

/// Gauss's of four points a side.
Rule gauss() {
    const double near = std::sqrt(3. / 7 - 2. / 7 * std::sqrt(6. / 5)),
                 far = std::sqrt(3. / 7 + 2. / 7 * std::sqrt(6. / 5)), heavy = (18 + std::sqrt(30.)) / 72,
                 light = (18 - std::sqrt(30.)) / 72;
    const std::array<glm::dvec2, 4> side{
        {{.5 - far / 2, light}, {.5 - near / 2, heavy}, {.5 + near / 2, heavy}, {.5 + far / 2, light}}};
    Rule rule;
    for (const glm::dvec2& x : side)
        for (const glm::dvec2& y : side) rule.emplace_back(x.x, y.x, x.y * y.y);
    return rule;
}

/// Many, somewhere in the squares of a grid: a border along the grid's lines is met by no error of all.
Rule scattered() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> within(0, 1);
    Rule rule;
    for (int i = 0; i < kFine; ++i)
        for (int j = 0; j < kFine; ++j) {
            const double x = (i + within(random)) / kFine, y = (j + within(random)) / kFine;
            rule.emplace_back(x, y, 1.0 / (kFine * kFine));
        }
    return rule;
}

/// The pdf over cells: Gauss's rule, and many points where light reaches a part of one.
class Integrals {
public:
    Integrals(BsdfProbe& probe, const ProbeMaterial& material, const glm::vec3& wo,
              const std::vector<Chart>& charts)
        : probe_(probe), material_(material), wo_(wo), charts_(charts), sums_(charts.size() * kCells) {
        static const Rule few = gauss(), many = scattered();
        std::vector<size_t> all(sums_.size());
        for (size_t i = 0; i < all.size(); ++i) all[i] = i;
        const std::vector<size_t> broken = integrate(all, few);
        integrate(broken, many);
    }
    const std::vector<double>& sums() const { return sums_; }

private:
    std::optional<Direction> at(size_t cell, double x, double y) const {
        const size_t chart = cell / kCells, i = cell % kCells / kAround, j = cell % kAround;
        auto found = charts_[chart].at((double(i) + x) / kRadial, (double(j) + y) / kAround);
        for (size_t before = 0; found && before < chart; ++before)
            if (charts_[before].cellOf(found->wi)) found.reset();
        return found;
    }

    /// Gives the cells for which that rule will not do: of which light reaches a part, by points and corners,
    /// or where the density differs by more than twofold.
    std::vector<size_t> integrate(const std::vector<size_t>& cells, const Rule& rule) {
        std::vector<BsdfQuery> queries;
        std::vector<glm::dvec2> factors;
        std::vector<size_t> owners, reached(sums_.size());
        for (const size_t cell : cells) {
            sums_[cell] = 0;
            for (const double x : {1e-9, 1 - 1e-9})
                for (const double y : {1e-9, 1 - 1e-9}) reached[cell] += at(cell, x, y).has_value();
            for (const glm::dvec3& point : rule) {
                const auto found = at(cell, point.x, point.y);
                if (!found) continue;
                ++reached[cell];
                queries.push_back(evalQuery(material_, wo_, glm::vec3(found->wi)));
                factors.emplace_back(found->solidAngle, point.z / double(kCells));
                owners.push_back(cell);
            }
        }
        const auto answers = probe_.ask(queries);
        std::vector<double> least(sums_.size(), 1e300), most(sums_.size());
        for (size_t k = 0; k < answers.size(); ++k) {
            const size_t cell = owners[k];
            const double density = double{answers[k].wi.w} * factors[k].x;
            sums_[cell] += density * factors[k].y;
            least[cell] = std::min(least[cell], density);
            most[cell] = std::max(most[cell], density);
        }
        std::vector<size_t> broken;
        for (const size_t cell : cells) {
            const bool partly =
                reached[cell] < rule.size() + 4 && (reached[cell] > 0 || besideReached(cell, reached));
            // The dark are done: the pdf is 0 at all that was asked.
            const bool dark = most[cell] == 0 && least[cell] == 0;
            if ((partly && !dark) || most[cell] > 2 * least[cell]) broken.push_back(cell);
        }
        return broken;
    }

    /// A border may cut through a cell and leave out all of its points.
    static bool besideReached(size_t cell, const std::vector<size_t>& reached) {
        const size_t first = cell / kCells * kCells;
        const int i = int(cell % kCells) / kAround, j = int(cell % kCells) % kAround;
        for (int di = -1; di <= 1; ++di)
            for (int dj = -1; dj <= 1; ++dj) {
                const int row = i + di, column = (j + dj + kAround) % kAround;
                if (row >= 0 && row < kRadial && reached[first + size_t(row * kAround + column)] > 0)
                    return true;
            }
        return false;
    }

    BsdfProbe& probe_;
    const ProbeMaterial& material_;
    glm::vec3 wo_;
    const std::vector<Chart>& charts_;
    std::vector<double> sums_;
};

}  // namespace

ChiSquare chiSquareOf(std::vector<Cell> cells) {
    constexpr double least = 20;
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return a.expected < b.expected; });
    ChiSquare result;
    result.freedom = -1;
    Cell pool;
    for (const Cell& cell : cells) {
        pool.expected += cell.expected;
        pool.seen += cell.seen;
        if (pool.expected < least) continue;
        result.statistic += (pool.seen - pool.expected) * (pool.seen - pool.expected) / pool.expected;
        ++result.freedom;
        pool = {};
    }
    if (result.freedom > 0) result.p = chiSquareTail(result.statistic, result.freedom);
    return result;
}

double sidak(double smallest, size_t count) {
    return -std::expm1(double(count) * std::log1p(-smallest));
}

ChiSquare lobeHistogram(BsdfProbe& probe, const ProbeMaterial& material, const glm::vec3& wo, int samples,
                        uint32_t seed, double& overshoot) {
    const std::vector<Chart> charts = chartsOf(material, glm::dvec3(wo));
    const Integrals integrals(probe, material, wo, charts);
    std::vector<Cell> cells;
    double total = 0;
    for (const double share : integrals.sums()) {
        cells.push_back({share * samples, 0});
        total += share;
    }
    overshoot = std::max(total - 1, 0.0);
    cells.push_back({std::max(1 - total, 0.0) * samples, 0});

    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BsdfQuery> draws;
    for (int i = 0; i < samples; ++i)
        draws.push_back(drawQuery(material, wo, {uniform(random), uniform(random), uniform(random)}));
    for (const BsdfAnswer& a : probe.ask(draws)) {
        size_t cell = cells.size() - 1;
        for (size_t chart = 0; chart < charts.size() && a.value.w == 1; ++chart)
            if (const auto found = charts[chart].cellOf(glm::dvec3(a.wi))) {
                cell = chart * kCells + *found;
                break;
            }
        ++cells[cell].seen;
    }
    return chiSquareOf(cells);
}

}  // namespace tilefarm
