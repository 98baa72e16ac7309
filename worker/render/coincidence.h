#pragma once

#include <vector>

#include "worker/bvh/bvh.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// Which surfaces of a scene share a part of a plane: a floor that is there twice, a decal in a wall, a glass
/// on a table, liquid that touches its glass. Such kernels have FEATURE_COINCIDENT_FACES.
struct Coincidence {
    bool any = false;
    /// By material: some face of it coincides with another, and light goes through one of the two.
    std::vector<bool> interfaces;
};

/// `bvh` over the primitives of `world`. Round shapes count where two of a kind touch and light goes through
/// one. About 1.1 µs of a processor for each triangle of a mesh (measured with a million of them).
Coincidence findCoincidence(const Bvh& bvh, const Scene& scene, const WorldGeometry& world);

}  // namespace tilefarm
