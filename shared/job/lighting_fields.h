#pragma once

// Part of the table in fields.h: a job's environment and lights.

#include "shared/job/appearance_fields.h"
#include "shared/job/lighting.h"

namespace tilefarm {

inline constexpr std::array kEnvironmentChoices{
    Choice<EnvironmentKind>{"auto", EnvironmentKind::automatic},
    Choice<EnvironmentKind>{"file", EnvironmentKind::file},
    Choice<EnvironmentKind>{"constant", EnvironmentKind::constant},
    Choice<EnvironmentKind>{"sky", EnvironmentKind::sky},
    Choice<EnvironmentKind>{"none", EnvironmentKind::none},
};
inline constexpr std::array kLightKindChoices{
    Choice<LightKind>{"point", LightKind::point},   Choice<LightKind>{"spot", LightKind::spot},
    Choice<LightKind>{"quad", LightKind::quad},     Choice<LightKind>{"directional", LightKind::directional},
    Choice<LightKind>{"sphere", LightKind::sphere},
};
inline constexpr std::array kLightUnitsChoices{
    Choice<LightUnits>{"radiometric", LightUnits::radiometric},
    Choice<LightUnits>{"photometric", LightUnits::photometric},
};
inline constexpr NumberRange kTurn{-360, 360};        // degrees
inline constexpr NumberRange kCoordinate{-1e9, 1e9};  // m
inline constexpr NumberRange kSize{1e-6, 1e9};        // m

template <typename Visitor>
void describe(Visitor& v, Is<SkySettings> auto& sky) {
    v.number({"sunElevation", "elevation of the sun above the horizon, degrees"}, sky.sunElevation,
             {-90, 90});
    v.number({"sunAzimuth", "azimuth of the sun, degrees clockwise from north (-z) seen from above"},
             sky.sunAzimuth, kTurn);
    v.number({"sunAngularDiameter", "angular diameter of the sun, degrees"}, sky.sunAngularDiameter, {0, 90});
    v.number({"sunIntensity", "scales the radiance of the sun's disk, not of the sky"}, sky.sunIntensity,
             {0, 1e6});
    v.number({"turbidity", "turbidity of the atmosphere: 1 clear to 10 hazy"}, sky.turbidity, {1, 10});
    v.number({"groundAlbedo", "albedo of the ground, which brightens the sky"}, sky.groundAlbedo, kShare);
    v.number({"altitude", "altitude of the viewer above sea level, m"}, sky.altitude, {0, 60000});
}

template <typename Visitor>
void describe(Visitor& v, Is<EnvironmentSettings> auto& environment) {
    v.choice({"kind",
              "file: scene.environment; constant: color; sky: a clear sky with sun; none; auto: file if "
              "scene.environment is given, white of radiance 1 if the scene has no light at all, else none"},
             environment.kind, kEnvironmentChoices);
    v.number({"intensity", "scales the radiance of the environment"}, environment.intensity, {0, 1e9});
    v.number({"rotation", "rotation of the environment around +y, degrees counter-clockwise seen from above"},
             environment.rotation, kTurn);
    v.triple({"color", "radiance of kind constant, W/(sr m²)"}, environment.color, kLightAmount);
    v.flag({"visible",
            "camera rays see the environment; off: they see black, while it still lights the scene and shows "
            "in reflections"},
           environment.visible);
    v.object({"sky", "sun and atmosphere of kind sky"}, environment.sky);
}

template <typename Visitor>
void describe(Visitor& v, Is<LightSettings> auto& light) {
    v.text({"name", "names the light in warnings and mattes"}, light.name, {0, 200});
    v.choice({"kind", "shape of the light", kRequired}, light.kind, kLightKindChoices);
    v.triple({"position", "centre of the light, m"}, light.position, kCoordinate);
    v.triple({"direction", "direction in which a spot or directional light shines; normal of a quad"},
             light.direction, kCoordinate);
    v.triple({"color", "colour of the light, linear Rec. 709; multiplies the intensity"}, light.color,
             kLightAmount);
    v.number({"intensity",
              "radiant intensity of point and spot, W/sr; irradiance of directional, W/m²; radiance of quad "
              "and sphere, W/(sr m²)"},
             light.intensity, kLightAmount);
    v.number({"innerCone", "half angle of the cone in which a spot has full intensity, degrees"},
             light.innerCone, {0, 90});
    v.number({"outerCone", "half angle at which a spot's intensity has fallen to 0, degrees"},
             light.outerCone, {0, 90});
    v.number({"angularDiameter",
              "angular diameter of a directional light, degrees; 0: all light from one direction"},
             light.angularDiameter, {0, 90});
    v.number({"width", "width of a quad, m"}, light.width, kSize);
    v.number({"height", "height of a quad, m"}, light.height, kSize);
    v.number({"roll", "rotation of a quad around its normal, degrees"}, light.roll, kTurn);
    v.number({"radius", "radius of a sphere, m"}, light.radius, kSize);
    v.flag({"twoSided", "a quad emits from both sides"}, light.twoSided);
}

}  // namespace tilefarm
