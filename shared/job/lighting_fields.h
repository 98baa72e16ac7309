#pragma once

// Part of the table in fields.h: what a job may say of light.

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
    v.number({"sunElevation", "degrees above the horizon"}, sky.sunElevation, {-90, 90});
    v.number({"sunAzimuth", "degrees clockwise from north (-z), seen from above"}, sky.sunAzimuth, kTurn);
    v.number({"sunAngularDiameter", "degrees"}, sky.sunAngularDiameter, {0, 90});
    v.number({"sunIntensity", "scales the sun's disk, not the sky"}, sky.sunIntensity, {0, 1e6});
    v.number({"turbidity", "amount of aerosol: 1 clear to 10 hazy"}, sky.turbidity, {1, 10});
    v.number({"groundAlbedo", ""}, sky.groundAlbedo, kShare);
    v.number({"altitude", "m above the sea"}, sky.altitude, {0, 60000});
}

template <typename Visitor>
void describe(Visitor& v, Is<EnvironmentSettings> auto& environment) {
    v.choice({"kind", "auto: the scene's file where it has one, white where nothing else lights the scene"},
             environment.kind, kEnvironmentChoices);
    v.number({"intensity", "scales its radiance"}, environment.intensity, {0, 1e9});
    v.number({"rotation", "degrees around +y, counter-clockwise seen from above"}, environment.rotation,
             kTurn);
    v.triple({"color", "radiance of a constant one, W/(sr m²)"}, environment.color, kLightAmount);
    v.flag({"visible", "to camera rays; light and reflections have it anyway"}, environment.visible);
    v.object({"sky", "of kind sky"}, environment.sky);
}

template <typename Visitor>
void describe(Visitor& v, Is<LightSettings> auto& light) {
    v.text({"name", "for people"}, light.name, {0, 200});
    v.choice({"kind", "", kRequired}, light.kind, kLightKindChoices);
    v.triple({"position", "m, of the centre"}, light.position, kCoordinate);
    v.triple({"direction", "where it shines; a quad's normal"}, light.direction, kCoordinate);
    v.triple({"color", "linear Rec. 709"}, light.color, kLightAmount);
    v.number({"intensity", "W/sr point, spot; W/m² directional; W/(sr m²) quad, sphere"}, light.intensity,
             kLightAmount);
    v.number({"innerCone", "degrees, half angle of a spot's full intensity"}, light.innerCone, {0, 90});
    v.number({"outerCone", "degrees, half angle of a spot"}, light.outerCone, {0, 90});
    v.number({"angularDiameter", "degrees, of a directional light"}, light.angularDiameter, {0, 90});
    v.number({"width", "m, of a quad"}, light.width, kSize);
    v.number({"height", "m, of a quad"}, light.height, kSize);
    v.number({"roll", "degrees, turns a quad around its normal"}, light.roll, kTurn);
    v.number({"radius", "m, of a sphere"}, light.radius, kSize);
    v.flag({"twoSided", "a quad that shines both ways"}, light.twoSided);
}

}  // namespace tilefarm
