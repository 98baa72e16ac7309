#pragma once

#include <span>
#include <vector>

#include "tests/property/any_material.h"

namespace tilefarm {

/// What a white furnace says of a material.
struct Furnace {
    glm::dvec3 energy{0}, sigma{0};  // that leaves for a unit of it that comes; its standard deviation
    double samples = 0;              // that it took
    double unsound = 0;              // that were infinite, NaN or negative
    bool tooMuch = false;            // energy above the bound, beyond doubt
};

/// How hard to look. More samples are taken, four times as many at a time, until the bound is 4 σ above the
/// mean or the mean beyond the bound without doubt.
struct FurnaceEffort {
    uint32_t first = 1024, last = 1u << 20;  // samples of a material
    double most = 1.005;
    /// Chance that materials which all keep their energy fail, by the Student distribution of the means of 32
    /// lattices with random starts; shared among materials, channels and looks (Šidák).
    double significance = 1e-3;
};

/// Whether more light leaves the materials than `most` of what comes, channel by channel.
std::vector<Furnace> furnace(BsdfProbe& probe, std::span<const SeenMaterial> materials,
                             const FurnaceEffort& effort = {});

}  // namespace tilefarm
