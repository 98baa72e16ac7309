#include "worker/render/lights/light_kinds.h"

#include <numbers>

namespace tilefarm {

void addEnvironment(double flux, double sceneRadius, LightList& lights, PackedLights& packed) {
    if (!(flux > 0)) return;
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_ENVIRONMENT;
    record.primitive = gpu::NO_INDEX;
    LightBounds bounds;
    bounds.infinite = true;
    bounds.thetaO = std::numbers::pi;
    bounds.intensity = flux / 4;  // irradiance, averaged over the orientations of a plane
    const uint32_t index = lights.next();
    if (!lights.add(record, glm::vec3(0), std::numbers::pi * sceneRadius * sceneRadius * flux, bounds)) return;
    packed.environmentLight = index;
    packed.features |= gpu::bit(gpu::FEATURE_ENVIRONMENT);
}

}  // namespace tilefarm
