#include "worker/render/lights/light_kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tilefarm {

void addPunctual(const PunctualLight& light, double sceneRadius, LightList& lights, PackedLights& packed) {
    gpu::LightRecord record{};
    record.primitive = gpu::NO_INDEX;
    record.p = glm::vec3(light.position);
    record.a = light.direction;
    record.b = {std::cos(light.innerCone), std::cos(light.outerCone), light.range};
    LightBounds bounds;
    bounds.lower = bounds.upper = record.p;
    bounds.axis = light.direction;
    bounds.intensity = luminance(glm::dvec3(light.color));
    double power = 0;
    switch (light.type) {
        case PunctualType::point:
            record.type = gpu::LIGHT_POINT;
            bounds.thetaO = std::numbers::pi;
            bounds.thetaE = std::numbers::pi / 2;
            power = 4 * std::numbers::pi * bounds.intensity;
            break;
        case PunctualType::spot:
            record.type = gpu::LIGHT_SPOT;
            bounds.thetaO = light.innerCone;
            bounds.thetaE = std::max(light.outerCone - light.innerCone, 0.f);
            power = std::max(2 * std::numbers::pi * (1 - std::cos(light.outerCone)), 1e-9) * bounds.intensity;
            break;
        case PunctualType::directional:
            record.type = gpu::LIGHT_DIRECTIONAL;
            bounds.infinite = true;
            bounds.axis = -light.direction;
            power = std::numbers::pi * sceneRadius * sceneRadius * bounds.intensity;
            break;
    }
    if (lights.add(record, light.color, power, bounds))
        packed.features |= gpu::bit(gpu::FEATURE_PUNCTUAL_LIGHTS);
}

}  // namespace tilefarm
