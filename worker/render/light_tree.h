#pragma once

#include <span>
#include <vector>

#include "shaders/gpu_types.h"

namespace tilefarm {

/// What a light, or a group of lights, can send at most, for the light tree.
struct LightBounds {
    glm::dvec3 lower{0}, upper{0};  // of its places; unused where infinite
    glm::dvec3 axis{0, 0, 1};       // cone of its normals; infinite: of the directions towards it
    double thetaO = 0;              // half angle of that cone, rad
    double thetaE = 0;              // how far beyond a normal it emits, rad, at most π/2
    double intensity = 0;           // greatest, luminance in W/sr; infinite: irradiance, W/m²
    bool twoSided = false;          // emits along −axis as well
    bool infinite = false;
};

/// Bounds of both. A cone that holds two opposite directions becomes the sphere. Either may be without intensity.
LightBounds unite(const LightBounds& a, const LightBounds& b);

struct LightTree {
    std::vector<gpu::LightTreeChild> children;  // two per node; node 0 is the root
    std::vector<uint32_t> trails;               // per light, AliasRecord::trail
};

/// A binary tree over at least two lights, at most LIGHT_TREE_DEPTH deep, by the surface area orientation heuristic
/// (Conty Estevez, Kulla 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting; binned as in pbrt-v4,
/// BVHLightSampler). Lights without a place form a subtree beside the rest, under a root that is balanced: there the
/// estimates know nothing of walls, so neither side may drown the other.
LightTree buildLightTree(std::span<const LightBounds> lights);

}  // namespace tilefarm
