#pragma once

#include <vector>

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"
#include "worker/render/light_counts.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// The lights of a scene with what chooses among them.
struct PackedLights {
    std::vector<gpu::LightRecord> records;
    std::vector<gpu::AliasRecord> alias;    // one per record
    std::vector<gpu::LightTreeChild> tree;  // empty where no tree chooses
    std::vector<uint32_t>
        primitiveLights;  // by primitive: index into records or NO_INDEX; empty where no surface emits
    uint32_t environmentLight = gpu::NO_INDEX;
    uint32_t groups = 0;  // that LightSelection::all asks one light of each; 0 where there is no choice
    LightCounts counts;
    uint32_t firstSun = 0, sunCount = 0;  // lights of type LIGHT_SUN follow each other
    uint64_t features = 0;                // FEATURE_* of the light kinds there are and of their selection
    uint64_t darkTriangles = 0;           // of an emissive material but with no light in their texture
};

/// From so many lights on a tree is worth its cost, and from two on where lights with and without a place
/// meet: by power a small lamp would drown in an environment. Otherwise LightSelection::tree chooses by
/// power. (A tree of the two triangles of a Cornell box costs 6 % more processor time for the same noise.)
inline constexpr size_t kLeastLightsForTree = 8;

/// `environmentFlux`: ∫ luminance dω of the environment, 0 for none. Powers are luminances: π L A for
/// a triangle or quad (twice that if it emits from both sides, emission textures and coverage averaged over
/// it), 4π I for a point, 2π (1 − cos outer) I for a spot; infinitely far lights weigh by what they send
/// through the disk of the scene's bounding sphere. Lights without power are left out.
PackedLights packLights(const Scene& scene, const WorldGeometry& world, double environmentFlux,
                        LightSelection selection = LightSelection::power);

}  // namespace tilefarm
