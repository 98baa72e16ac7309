#include "worker/render/lights/light_list.h"

#include <cmath>
#include <numbers>

#include "worker/render/texture_average.h"

namespace tilefarm {

bool LightList::add(gpu::LightRecord record, const glm::vec3& value, double power, const LightBounds& bound,
                    std::optional<uint64_t> object) {
    if (!(power > 0) || !std::isfinite(power)) return false;
    record.red = value.r;
    record.green = value.g;
    record.blue = value.b;
    if (!object || object != lastObject_) groups.push_back(next());
    lastObject_ = object;
    records.push_back(record);
    powers.push_back(power);
    bounds.push_back(bound);
    return true;
}

double luminance(const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

LightBounds flatBounds(const std::initializer_list<glm::vec3>& corners, const glm::dvec3& normal,
                       double intensity, bool twoSided) {
    LightBounds b;
    b.lower = b.upper = *corners.begin();
    for (const glm::vec3& corner : corners) {
        b.lower = glm::min(b.lower, glm::dvec3(corner));
        b.upper = glm::max(b.upper, glm::dvec3(corner));
    }
    b.axis = glm::normalize(normal);
    b.thetaE = std::numbers::pi / 2;
    b.intensity = intensity;
    b.twoSided = twoSided;
    return b;
}

bool emitsEvenly(const Material& material) {
    return !material.unlit && material.emission != glm::vec3(0) && !material.emissionTexture &&
           material.clearcoat == 0 && (material.alphaMode == AlphaMode::opaque || !material.baseColorTexture);
}

glm::vec3 coveredEmission(const Material& material) {
    return material.emission * static_cast<float>(coverageOf(material, material.alpha));
}

}  // namespace tilefarm
