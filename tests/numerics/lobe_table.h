#pragma once

#include <vector>

#include "tests/shader/lobe_checks.h"

/// Every lobe that shaders/bsdf has, alone where it can be, and mixtures of them: the rows of cases 18, 19
/// and 22.
namespace tilefarm {

/// How often longer than wide the facets are: 1, and those of KHR_materials_anisotropy at medium and full
/// strength.
inline constexpr float kStretches[]{1, 4, 25};

/// Lobes of that roughness, which is the larger one where they are stretched; 0 is the mirror. Metal,
/// plastic, glass from either side, thin panes, and mixtures of them with a diffuse base.
std::vector<LobeRow> plainLobes(float alpha, float stretch = 1);
/// Also films, compensation and the coat: what quick forms look at. The rows of tests/shader/bsdf_*_test.cpp
/// ask the same of the rest.
std::vector<LobeRow> basicLobes(float alpha);
/// Also specular colour, Schlick's curve, measured metal, Beckmann and Phong. Stretched ones are without
/// compensation and the coat, which know one roughness only.
std::vector<LobeRow> facetLobes(float alpha, float stretch = 1);
/// Sheen of the roughness whose square is alpha (which no value makes a mirror), and GTR1 coats.
std::vector<LobeRow> hazeLobes(float alpha);
/// Lobes without a roughness, or whose shape alone follows it: diffuse ones and Disney's sheen.
std::vector<LobeRow> diffuseLobes();
/// Layers over a base of that roughness, which are not reciprocal: what they keep from the base depends on
/// one direction alone.
std::vector<LobeRow> layeredLobes(float alpha);

}  // namespace tilefarm
