#pragma once

#include <vector>

#include "shaders/gpu_types.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// The lights of a scene with the probability of choosing each, in proportion to its power.
struct PackedLights {
    std::vector<gpu::LightRecord> records;
    std::vector<gpu::AliasRecord> alias;  // one per record
    std::vector<uint32_t>
        primitiveLights;  // by primitive: index into records or NO_INDEX; empty without emissive triangles
    uint32_t environmentLight = gpu::NO_INDEX;
    uint64_t features = 0;       // FEATURE_* of the light kinds there are
    uint64_t darkTriangles = 0;  // of an emissive material but with no light in their texture
};

/// `environmentFlux`: ∫ luminance dω of the environment, 0 for none. Powers are luminances: π L A for
/// a triangle (twice that if double-sided, emission textures averaged over it), 4π I for a point,
/// 2π (1 − cos outer) I for a spot; infinitely far lights weigh by what they send through the disk of the
/// scene's bounding sphere. Lights without power are left out.
PackedLights packLights(const Scene& scene, const WorldGeometry& world, double environmentFlux);

}  // namespace tilefarm
