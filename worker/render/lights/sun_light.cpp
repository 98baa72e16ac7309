#include "worker/render/lights/light_kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tilefarm {

// Below 1e-6 rad fp32 directions cannot tell the disk's inside from its outside: such a light is a delta.
bool isSun(const PunctualLight& light) {
    return light.type == PunctualType::directional && light.angularRadius >= 1e-6f;
}

// A disk of even radiance that gives a plane across its axis the irradiance `color`: E = π L sin² θmax.
void addSun(const PunctualLight& light, double sceneRadius, LightList& lights, PackedLights& packed) {
    const double theta = std::min(double{light.angularRadius}, std::numbers::pi / 2), half = std::sin(theta / 2);
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_SUN;
    record.primitive = gpu::NO_INDEX;
    record.a = light.direction;
    record.b.x = static_cast<float>(2 * half * half);
    LightBounds bounds;
    bounds.infinite = true;
    bounds.axis = -light.direction;
    bounds.thetaO = theta;
    bounds.intensity = luminance(glm::dvec3(light.color));
    const glm::dvec3 radiance = glm::dvec3(light.color) / (std::numbers::pi * std::sin(theta) * std::sin(theta));
    if (lights.add(record, radiance, std::numbers::pi * sceneRadius * sceneRadius * bounds.intensity, bounds))
        packed.features |= gpu::bit(gpu::FEATURE_SUN_LIGHTS);
}

}  // namespace tilefarm
