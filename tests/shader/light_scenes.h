#pragma once

#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "worker/scene/scene.h"

/// Scenes around one light each, for tests of every kind of light.
namespace tilefarm {

struct LightScene {
    std::string name;
    Scene scene;
    glm::dvec3 point{0};          // where it is sampled from, on a plane that faces +y
    glm::dvec3 towards{0, 1, 0};  // cone that holds all directions to the light
    double cosCone = -1;
};

AreaLight quadLight(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, float radiance = 1);
AreaLight sphereLight(const glm::dvec3& centre, double radius, float radiance = 1);
PunctualLight sunLight(const glm::vec3& direction, float angularRadius, float irradiance = 1);
/// Radiance in one texel of an otherwise black map.
Environment oneTexelSun(uint32_t width, uint32_t height, uint32_t x, uint32_t y, float radiance);

/// Every kind of light that has an extent, alone in its scene.
std::vector<LightScene> lightsWithExtent();
/// Of a test whose parameter counts them.
std::string nameOfLight(const testing::TestParamInfo<size_t>& info);

}  // namespace tilefarm
