#include "worker/render/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr int kBins = 12;
// What rounding to float may take from a bound: a few last digits.
constexpr double kSlack = 1e-6;

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The smallest cone around both (pbrt-v4, Union of DirectionCone).
void uniteCones(LightBounds& out, const LightBounds& a, const LightBounds& b) {
    const LightBounds &wide = a.thetaO >= b.thetaO ? a : b, &narrow = a.thetaO >= b.thetaO ? b : a;
    const double apart = angleBetween(wide.axis, narrow.axis);
    out.axis = wide.axis;
    out.thetaO = wide.thetaO;
    if (std::min(apart + narrow.thetaO, pi) <= wide.thetaO) return;
    const double theta = (wide.thetaO + narrow.thetaO + apart) / 2;
    const glm::dvec3 pole = glm::cross(wide.axis, narrow.axis);
    const double sine = glm::length(pole);
    if (theta >= pi || sine < 1e-12) {
        // Opposite axes have no plane to turn in; equal ones need no turn.
        out.thetaO = theta < pi && glm::dot(wide.axis, narrow.axis) > 0 ? theta : pi;
        return;
    }
    const glm::dvec3 side = glm::cross(pole / sine, wide.axis);
    const double turn = theta - wide.thetaO;
    out.axis = glm::normalize(wide.axis * std::cos(turn) + side * std::sin(turn));
    out.thetaO = theta;
}

// Solid angle of the emission, weighted by its cosine (Conty Estevez, Kulla 2018, eq. 1).
double orientationMeasure(const LightBounds& b) {
    const double thetaW = std::min(b.thetaO + b.thetaE, pi), sinO = std::sin(b.thetaO), cosO = std::cos(b.thetaO);
    return 2 * pi * (1 - cosO) +
           pi / 2 * (2 * thetaW * sinO - std::cos(b.thetaO - 2 * thetaW) - 2 * b.thetaO * sinO + cosO);
}

// The kernel bounds lights by spheres, so it is a sphere's surface that stands for the probability of being near.
double cost(const LightBounds& b) {
    if (b.intensity == 0) return 0;
    const glm::dvec3 diagonal = b.upper - b.lower;
    return b.intensity * orientationMeasure(b) * (b.infinite ? 1 : glm::dot(diagonal, diagonal));
}

glm::dvec3 middle(const LightBounds& b) { return b.infinite ? b.axis : 0.5 * (b.lower + b.upper); }

class Builder {
public:
    Builder(std::span<const LightBounds> lights, LightTree& tree) : lights_(lights), tree_(tree) {
        tree_.trails.assign(lights.size(), 0);
    }

    void run() {
        std::vector<uint32_t> order(lights_.size());
        std::iota(order.begin(), order.end(), 0u);
        const auto places = std::stable_partition(order.begin(), order.end(),
                                                  [&](uint32_t i) { return !lights_[i].infinite; });
        const auto finite = static_cast<size_t>(places - order.begin());
        const std::span<uint32_t> all(order);
        if (finite == 0 || finite == all.size())
            subtree(all, 0, 0);
        else
            node(all.first(finite), all.subspan(finite), 0, 0, gpu::LIGHT_TREE_BALANCED);
    }

private:
    struct Subtree {
        LightBounds bounds;
        uint32_t reference;
    };

    Subtree subtree(std::span<uint32_t> part, uint32_t depth, uint32_t trail) {
        if (part.size() == 1) {
            tree_.trails[part[0]] = trail;
            return {lights_[part[0]], gpu::LIGHT_TREE_LEAF | part[0]};
        }
        const size_t cut = split(part, depth);
        return node(part.first(cut), part.subspan(cut), depth, trail, 0);
    }

    Subtree node(std::span<uint32_t> first, std::span<uint32_t> second, uint32_t depth, uint32_t trail,
                 uint32_t flags) {
        const size_t at = tree_.children.size();
        tree_.children.resize(at + 2);
        const Subtree a = subtree(first, depth + 1, trail), b = subtree(second, depth + 1, trail | 1u << depth);
        tree_.children[at] = packed(a, flags);
        tree_.children[at + 1] = packed(b, flags);
        return {unite(a.bounds, b.bounds), static_cast<uint32_t>(at * gpu::LIGHT_TREE_CHILD_TEXELS)};
    }

    // How many of `part`, which is put in order, go to the first child.
    size_t split(std::span<uint32_t> part, uint32_t depth) const {
        glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
        for (const uint32_t i : part) {
            lower = glm::min(lower, middle(lights_[i]));
            upper = glm::max(upper, middle(lights_[i]));
        }
        const glm::dvec3 extent = upper - lower;
        const double widest = std::max({extent.x, extent.y, extent.z});
        const int wide = extent.x == widest ? 0 : extent.y == widest ? 1 : 2;
        const size_t half = part.size() / 2;
        // A lopsided tree must not run out of trail.
        const bool mustHalve = part.size() > size_t{1} << std::min(gpu::LIGHT_TREE_DEPTH - depth - 2, 31u);
        Split best;
        if (widest > 0 && !mustHalve)
            for (int axis = 0; axis < 3; ++axis)
                if (extent[axis] > 0) binned(part, axis, lower[axis], extent[axis], widest, best);
        if (best.axis >= 0) {
            const auto cut = std::partition(part.begin(), part.end(), [&](uint32_t i) {
                return binOf(i, best.axis, lower[best.axis], extent[best.axis]) <= best.bin;
            });
            return static_cast<size_t>(cut - part.begin());
        }
        std::nth_element(part.begin(), part.begin() + static_cast<ptrdiff_t>(half), part.end(),
                         [&](uint32_t a, uint32_t b) {
                             const double x = middle(lights_[a])[wide], y = middle(lights_[b])[wide];
                             return x < y || (x == y && a < b);
                         });
        return half;
    }

    struct Split {
        double cost = std::numeric_limits<double>::infinity();
        int axis = -1, bin = 0;
    };

    int binOf(uint32_t light, int axis, double lower, double extent) const {
        return std::clamp(static_cast<int>((middle(lights_[light])[axis] - lower) / extent * kBins), 0, kBins - 1);
    }

    void binned(std::span<const uint32_t> part, int axis, double lower, double extent, double widest,
                Split& best) const {
        std::array<LightBounds, kBins> bins, behind;
        std::array<size_t, kBins> count{};
        for (const uint32_t i : part) {
            const auto bin = static_cast<size_t>(binOf(i, axis, lower, extent));
            bins[bin] = count[bin]++ == 0 ? lights_[i] : unite(bins[bin], lights_[i]);
        }
        for (size_t bin = kBins - 1; bin > 0; --bin)
            behind[bin - 1] = bin == kBins - 1 ? bins[bin] : unite(bins[bin], behind[bin]);
        LightBounds before;
        size_t taken = 0;
        for (size_t bin = 0; bin + 1 < kBins; ++bin) {
            before = unite(before, bins[bin]);
            taken += count[bin];
            if (taken == 0 || taken == part.size()) continue;
            const double total = (cost(before) + cost(behind[bin])) * widest / extent;
            if (total < best.cost) best = {total, axis, static_cast<int>(bin)};
        }
    }

    static gpu::LightTreeChild packed(const Subtree& subtree, uint32_t flags) {
        const LightBounds& b = subtree.bounds;
        gpu::LightTreeChild child{};
        child.centre = glm::vec3(0.5 * (b.lower + b.upper));
        child.radius = static_cast<float>(
            0.5 * glm::length(b.upper - b.lower) * (1 + kSlack) +
            kSlack * std::max({std::abs(child.centre.x), std::abs(child.centre.y), std::abs(child.centre.z)}));
        child.axis = glm::vec3(b.axis);
        child.intensity = static_cast<float>(b.intensity);
        child.cosThetaO = static_cast<float>(std::max(std::cos(b.thetaO) - kSlack, -1.0));
        child.cosThetaE = static_cast<float>(std::max(std::cos(b.thetaE) - kSlack, 0.0));
        child.flags = flags | (b.twoSided ? gpu::LIGHT_TREE_TWO_SIDED : 0u) |
                      (b.infinite ? gpu::LIGHT_TREE_INFINITE : 0u);
        child.reference = subtree.reference;
        return child;
    }

    std::span<const LightBounds> lights_;
    LightTree& tree_;
};

}  // namespace

LightBounds unite(const LightBounds& a, const LightBounds& b) {
    if (a.intensity == 0) return b;
    if (b.intensity == 0) return a;
    LightBounds out;
    out.lower = glm::min(a.lower, b.lower);
    out.upper = glm::max(a.upper, b.upper);
    uniteCones(out, a, b);
    out.thetaE = std::max(a.thetaE, b.thetaE);
    out.intensity = a.intensity + b.intensity;
    out.twoSided = a.twoSided || b.twoSided;
    out.infinite = a.infinite && b.infinite;
    return out;
}

LightTree buildLightTree(std::span<const LightBounds> lights) {
    // One unit for all, so that neither 1e-30 nor 1e30 leaves the range of a float.
    double largest = 0;
    for (const LightBounds& light : lights) largest = std::max(largest, light.intensity);
    std::vector<LightBounds> scaled(lights.begin(), lights.end());
    for (LightBounds& light : scaled) light.intensity /= largest;
    LightTree tree;
    Builder(scaled, tree).run();
    return tree;
}

}  // namespace tilefarm
