#include "worker/render/albedo_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>

#include "shaders/gpu_types.h"
#include "worker/render/host_facets.h"
#include "worker/render/table_cache.h"

namespace tilefarm {
namespace {

constexpr size_t kSize = gpu::ALBEDO_TABLE_SIZE;
// Points of the quadrature: a Fibonacci lattice, which resolves edges in either dimension (light that
// leaves below the horizon, the critical angle) as finely as its number of points.
constexpr int kPoints = 987, kStep = 610;

using Row = std::array<double, kSize>;

/// An albedo at the table's points, and its averages 2 ∫ E cosθ dcosθ.
struct Grid {
    std::array<Row, kSize> rows{};
    Row averages{};
};

// With cosθ = x², over the linear interpolant that the shader sees.
double averageOf(const Row& row) {
    constexpr int kSteps = 1024;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = (i + 0.5) / kSteps, at = x * (kSize - 1);
        const size_t cell = std::min(static_cast<size_t>(at), kSize - 2);
        const double f = at - static_cast<double>(cell);
        sum += (row[cell] * (1 - f) + row[cell + 1] * f) * 4 * x * x * x;
    }
    return sum / kSteps;
}

double cosineOf(double column) {
    const double root = column / (kSize - 1);
    return root * root;
}

double roughnessOf(double row) {
    return row / (kSize - 1);
}

/// A texel: the values at (x, y) and its neighbours, through `value(y, x)`; then the averages.
template <typename Value, typename Average>
std::vector<glm::vec4> texelsOf(const Value& value, const Average& average) {
    std::vector<glm::vec4> texels;
    texels.reserve(kSize * (kSize + 1));
    for (size_t y = 0; y < kSize; ++y)
        for (size_t x = 0; x < kSize; ++x) {
            const size_t x1 = std::min(x + 1, kSize - 1), y1 = std::min(y + 1, kSize - 1);
            texels.emplace_back(value(y, x), value(y, x1), value(y1, x), value(y1, x1));
        }
    for (size_t x = 0; x < kSize; ++x)
        texels.emplace_back(average(x), average(std::min(x + 1, kSize - 1)), average(x), average(x));
    return texels;
}

// Undone by firstOfPairs and secondOfPairs of shaders/bsdf/albedo_table.glsl.
float packPair(double first, double second) {
    const auto low = static_cast<uint32_t>(std::lround(std::clamp(first, 0.0, 1.0) * 65535));
    const auto high = static_cast<uint32_t>(std::lround(std::clamp(second, 0.0, 1.0) * 32256)) + 128;
    return std::bit_cast<float>(high << 16 | low);
}

void appendPairs(std::vector<glm::vec4>& tables, const Grid& first, const Grid& second) {
    const auto texels =
        texelsOf([&](size_t y, size_t x) { return packPair(first.rows[y][x], second.rows[y][x]); },
                 [&](size_t x) { return packPair(first.averages[x], second.averages[x]); });
    tables.insert(tables.end(), texels.begin(), texels.end());
}

// An index of 0 stands for perfect reflection at the rim, and refracts as glass.
double indexOf(const InterfaceKind& kind) {
    return kind.ior == 0 ? 1.5 : double{kind.ior};
}

double fresnelOf(const InterfaceKind& kind, double cosTheta, double eta) {
    if (kind.ior == 0) return fresnelSchlick(0, cosTheta, eta);
    return kind.fresnel == Fresnel::schlick ? fresnelSchlick(cosTheta, eta)
                                            : fresnelDielectric(cosTheta, eta);
}

void addRefracted(InterfaceAlbedos& sum, const InterfaceKind& kind, const HostFacets& facets,
                  const glm::dvec3& wo, const glm::dvec3& h, double reflected) {
    const double ior = indexOf(kind);
    for (const int side : {0, 1}) {
        const double eta = side == 0 ? ior : 1 / ior;
        glm::dvec3 wi;
        if (!refracted(wo, h, eta, wi)) {
            const bool total = 1 - (1 - glm::dot(wo, h) * glm::dot(wo, h)) / (eta * eta) <= 0;
            const double f = total ? 1 : fresnelOf(kind, glm::dot(wo, h), eta);
            sum.both[side] += f * reflected;
            if (total) sum.clear[side] += reflected;
            continue;
        }
        const double f = fresnelOf(kind, glm::dot(wo, h), eta), across = facets.weight(wo, wi, h);
        sum.both[side] += f * reflected + (1 - f) * across;
        sum.clear[side] += across;
    }
}

// Where cosθ meets α, near the corner of grazing angles on smooth surfaces, an albedo bends by more than the
// tables' lines between their points show: by 0.01 to 0.1. There the points are raised until the lines are
// nowhere below, so that shaders keep too much from what lies beneath, never too little.
constexpr double kFirstCell[]{1e-6, 1e-5, 5e-5, 2e-4, 5e-4};
constexpr size_t kBentColumns = 8, kSmoothRows = 5;
constexpr glm::dvec2 kWithin[]{{0.5, 0.5}, {0, 0.5}, {0.5, 0}};

// A share of light stays at 1 or below; what is above already is none (sheen).
void raiseTo(double& point, double wanted) {
    point = std::max(point, point > 1 ? wanted : std::min(wanted, 1.0));
}

// Adds to the corners of a cell what its interpolant lacks at a fraction `at` of it.
void raise(Grid& grid, size_t y, size_t x, const glm::dvec2& at, double albedo) {
    double* corners[]{&grid.rows[y][x], &grid.rows[y][x + 1], &grid.rows[y + 1][x], &grid.rows[y + 1][x + 1]};
    const double shown =
        glm::mix(glm::mix(*corners[0], *corners[1], at.x), glm::mix(*corners[2], *corners[3], at.x), at.y);
    for (double* corner : corners) raiseTo(*corner, *corner + albedo - shown);
}

template <size_t n>
std::array<Grid, n> tabulated(
    const std::function<std::array<double, n>(double cosTheta, double roughness)>& albedos, size_t bentRows) {
    std::array<Grid, n> grids;
    const auto each = [&](double cosTheta, double roughness, const auto& take) {
        const auto values = albedos(cosTheta, roughness);
        for (size_t i = 0; i < n; ++i) take(grids[i], values[i]);
    };
    for (size_t y = 0; y < kSize; ++y) {
        for (size_t x = 0; x < kSize; ++x)
            each(cosineOf(double(x)), roughnessOf(double(y)), [&](Grid& g, double e) { g.rows[y][x] = e; });
        for (const double cosTheta : kFirstCell)
            each(cosTheta, roughnessOf(double(y)), [&](Grid& g, double e) {
                const double share = std::sqrt(cosTheta) * (kSize - 1);
                double &rim = g.rows[y][0], &next = g.rows[y][1];
                raiseTo(rim, (e - share * next) / (1 - share));
                raiseTo(next, (e - (1 - share) * rim) / share);  // where the rim is at 1 already
            });
    }
    for (size_t y = 0; y < bentRows; ++y)
        for (size_t x = 0; x < kBentColumns; ++x)
            for (const glm::dvec2& at : kWithin)
                each(cosineOf(double(x) + at.x), roughnessOf(double(y) + at.y),
                     [&](Grid& g, double e) { raise(g, y, x, at, e); });
    for (Grid& grid : grids)
        for (size_t y = 0; y < kSize; ++y) grid.averages[y] = averageOf(grid.rows[y]);
    return grids;
}

std::vector<glm::vec4> buildInterfaceTables(const InterfaceKind& kind) {
    const auto grids = tabulated<6>(
        [&](double cosTheta, double roughness) {
            const InterfaceAlbedos e = interfaceAlbedos(cosTheta, roughness * roughness, kind);
            return std::array{e.reflected, e.all, e.both[0], e.clear[0], e.both[1], e.clear[1]};
        },
        kSmoothRows);
    std::vector<glm::vec4> tables;
    appendPairs(tables, grids[0], grids[1]);
    if (kind.solid) {
        appendPairs(tables, grids[2], grids[3]);
        appendPairs(tables, grids[4], grids[5]);
    }
    return tables;
}

std::string keyOf(const InterfaceKind& kind) {
    return fmt::format("interface {} {} {} {}", std::bit_cast<uint32_t>(kind.ior), int(kind.microfacets),
                       int(kind.fresnel), kind.solid);
}

}  // namespace

InterfaceAlbedos interfaceAlbedos(double cosTheta, double alpha, const InterfaceKind& kind) {
    const double z = std::clamp(cosTheta, 1e-6, 1.0), ior = indexOf(kind);
    const glm::dvec3 wo(std::sqrt(1 - z * z), 0, z);
    // A roughness of 0 is the limit of small ones; a single normal, then.
    const HostFacets facets{kind.microfacets, std::max(alpha, 1e-9)};
    const int points = alpha == 0 ? 1 : kPoints;
    InterfaceAlbedos sum;
    for (int i = 0; i < points; ++i) {
        const glm::dvec3 h =
            alpha == 0 ? glm::dvec3(0, 0, 1)
                       : facets.sample(wo, double(i * kStep % kPoints) / kPoints, (i + 0.5) / kPoints);
        const double cosine = glm::dot(wo, h);
        if (cosine <= 0) continue;
        const glm::dvec3 wi = 2 * cosine * h - wo;
        const double reflected = wi.z > 0 ? facets.weight(wo, wi, h) : 0;
        sum.all += reflected;
        sum.reflected += ior == 1 ? 0 : fresnelOf(kind, cosine, ior) * reflected;
        if (kind.solid) addRefracted(sum, kind, facets, wo, h, reflected);
    }
    const double n = points;
    return {sum.reflected / n,
            sum.all / n,
            {sum.both[0] / n, sum.both[1] / n},
            {sum.clear[0] / n, sum.clear[1] / n}};
}

double reflectionAlbedo(double cosTheta, double alpha, double ior) {
    return interfaceAlbedos(cosTheta, alpha, {.ior = static_cast<float>(ior)}).reflected;
}

std::vector<glm::vec4> tabulateAlbedo(const std::function<double(double, double)>& albedo, size_t bentRows) {
    const Grid grid = tabulated<1>(
        [&](double cosTheta, double roughness) { return std::array{albedo(cosTheta, roughness)}; },
        bentRows)[0];
    return texelsOf([&](size_t y, size_t x) { return static_cast<float>(grid.rows[y][x]); },
                    [&](size_t x) { return static_cast<float>(grid.averages[x]); });
}

std::vector<glm::vec4> buildAlbedoTable(double ior) {
    return tabulateAlbedo([&](double cosTheta, double roughness) {
        return reflectionAlbedo(cosTheta, roughness * roughness, ior);
    });
}

const std::vector<glm::vec4>& interfaceTables(const InterfaceKind& kind) {
    static std::mutex mutex;
    static std::map<InterfaceKind, std::vector<glm::vec4>> known;
    const std::lock_guard lock(mutex);
    std::vector<glm::vec4>& tables = known[kind];
    if (tables.empty()) tables = tableOnce(keyOf(kind), [&] { return buildInterfaceTables(kind); });
    return tables;
}

float dispersedIor(float ior, float dispersion, uint32_t channel) {
    if (ior == 0 || channel == 1) return ior;
    return std::clamp(ior + (float(channel) - 1) * (ior - 1) * 0.025f * dispersion, 1.0f, 1000.0f);
}

std::vector<glm::vec4> dispersedTables(const InterfaceKind& solid, float dispersion) {
    std::vector<glm::vec4> all;
    for (const uint32_t channel : {0u, 1u, 2u}) {
        InterfaceKind kind = solid;
        kind.ior = dispersedIor(solid.ior, dispersion, channel);
        const auto& tables = interfaceTables(kind);
        all.insert(all.end(), tables.begin(), tables.end());
    }
    return all;
}

}  // namespace tilefarm
