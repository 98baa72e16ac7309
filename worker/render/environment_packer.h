#pragma once

#include <vector>

#include "shaders/gpu_types.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// An environment as shaders/lights/environment.glsl reads it.
struct PackedEnvironment {
    std::vector<glm::vec4> texels;        // rgb radiance, a = luminance · sinθ of the row's middle
    std::vector<gpu::AliasRecord> alias;  // over texels by a
    uint32_t width = 0, height = 0;
    double weightSum = 0;  // Σ a
    double flux() const;   // ∫ luminance dω, approximately: the midpoint sum
    bool lit() const { return weightSum > 0; }
};

PackedEnvironment packEnvironment(const Environment& environment);

}  // namespace tilefarm
