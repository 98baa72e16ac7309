#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "shared/job/color.h"

namespace tilefarm {

enum class EnvironmentKind : uint8_t {
    automatic,  // the scene's file where it has one; white where nothing else lights the scene
    file,
    constant,
    sky,  // sun and sky
    none,
};

/// The sun and the clear sky that it lights.
struct SkySettings {
    double sunElevation = 45;           // degrees above the horizon
    double sunAzimuth = 135;            // degrees clockwise from north (−z), seen from above
    double sunAngularDiameter = 0.545;  // degrees; the disk is a light of its own
    double sunIntensity = 1;            // scales the disk, not the sky
    double turbidity = 1;               // amount of aerosol; 1 clear … 10 hazy
    double groundAlbedo = 0.3;
    double altitude = 0;  // m above the sea
    friend bool operator==(const SkySettings&, const SkySettings&) = default;
};

/// What surrounds the scene.
struct EnvironmentSettings {
    EnvironmentKind kind = EnvironmentKind::automatic;
    double intensity = 1;  // scales its radiance
    double rotation = 0;   // degrees around +y, counter-clockwise seen from above
    Color color{1, 1, 1};  // of a constant one
    bool visible = true;   // to camera rays; light and reflections have it anyway
    SkySettings sky;
    friend bool operator==(const EnvironmentSettings&, const EnvironmentSettings&) = default;
};

enum class LightKind : uint8_t { point, spot, directional, quad, sphere };

/// What the numbers of a file's KHR_lights_punctual are.
enum class LightUnits : uint8_t {
    radiometric,  // W/sr and W/m², as the lights of a job
    photometric,  // candela and lux: divided by 683 lm/W
};

/// A light that a job adds to its scene.
struct LightSettings {
    std::string name;
    LightKind kind = LightKind::point;
    std::array<double, 3> position{0, 0, 0};    // m
    std::array<double, 3> direction{0, -1, 0};  // where it shines; a quad's normal
    Color color{1, 1, 1};
    double intensity = 1;                  // W/sr point, spot; W/m² directional; W/(sr m²) quad, sphere
    double innerCone = 0, outerCone = 45;  // degrees, half angles of a spot
    double angularDiameter = 0;            // degrees, directional
    double width = 1, height = 1;          // m, quad
    double roll = 0;                       // degrees: turns a quad around its normal
    double radius = 0.1;                   // m, sphere
    bool twoSided = false;                 // quad
    friend bool operator==(const LightSettings&, const LightSettings&) = default;
};

}  // namespace tilefarm
