#pragma once

#include <vector>

#include "shaders/gpu_types.h"
#include "worker/bvh/bvh.h"
#include "worker/render/fog_parameters.h"
#include "worker/render/light_counts.h"
#include "worker/render/media.h"
#include "worker/render/renderer.h"
#include "worker/scene/world.h"
#include "worker/vk/buffer.h"

namespace tilefarm {

/// A scene on a device: the texel buffers that path_trace.comp binds first, in the order of BINDING_*.
struct GpuScene {
    std::vector<gpu::TexelBuffer> buffers;
    uint64_t features = 0;
    uint32_t vertexTexels = 1;
    uint32_t stackSize = 0;  // SPEC_STACK_SIZE: entries that a traversal may have waiting
    uint32_t lightCount = 0;
    uint32_t lightGroups = 0;  // 0: lights are not chosen from each group
    uint32_t lightRules = 0;   // LIGHTS_*
    LightCounts lights;
    uint32_t environmentLight = gpu::NO_INDEX;
    uint32_t environmentWidth = 0, environmentHeight = 0;
    double environmentWeightSum = 0;
    double environmentTurns = 0;  // rotation, of a full turn
    bool environmentHidden = false;
    uint32_t firstSun = 0, sunCount = 0;
    uint64_t triangles = 0;
    uint32_t slots = 0;                // triangles and shapes in BINDING_TRIANGLES
    std::vector<uint32_t> shapeSlots;  // first texels of the shapes there
    double environmentFlux = 0;
    PlacedFog fog;
    Solids solids;
    std::vector<uint32_t> images;  // of the scene, in the order of their texels
};

/// Packs and uploads everything but the camera. `extraFeatures`: effects that camera and settings call for.
/// `like`: an earlier moment of the same scene, to share what time does not change: environment and images.
GpuScene makeGpuScene(const gpu::Device& device, const Scene& scene, const WorldGeometry& world,
                      const RenderSettings& settings, uint64_t extraFeatures, PrepareTimes& times,
                      const GpuScene* like = nullptr);

/// The members of FrameParameters that say where the lights are.
void setLights(gpu::FrameParameters& parameters, const GpuScene& scene);

}  // namespace tilefarm
