#pragma once

// Part of the table in fields.h: cameras, time, and where samples go.

#include "shared/job/lighting_fields.h"
#include "shared/job/viewing.h"

namespace tilefarm {

inline constexpr std::array kViewChoices{
    Choice<ViewKind>{"scene", ViewKind::scene},
    Choice<ViewKind>{"perspective", ViewKind::perspective},
    Choice<ViewKind>{"orthographic", ViewKind::orthographic},
    Choice<ViewKind>{"panorama", ViewKind::panorama},
};
inline constexpr std::array kIntegratorChoices{
    Choice<Integrator>{"path", Integrator::path},
    Choice<Integrator>{"whitted", Integrator::whitted},
    Choice<Integrator>{"raster", Integrator::raster},
    Choice<Integrator>{"ambient-occlusion", Integrator::ambientOcclusion},
    Choice<Integrator>{"albedo", Integrator::albedo},
    Choice<Integrator>{"normal", Integrator::normal},
    Choice<Integrator>{"geometric-normal", Integrator::geometricNormal},
    Choice<Integrator>{"depth", Integrator::depth},
    Choice<Integrator>{"uv", Integrator::uv},
    Choice<Integrator>{"material", Integrator::material},
    Choice<Integrator>{"object", Integrator::object},
};
inline constexpr std::array kPixelFilterChoices{
    Choice<PixelFilter>{"box", PixelFilter::box},
    Choice<PixelFilter>{"tent", PixelFilter::tent},
    Choice<PixelFilter>{"gaussian", PixelFilter::gaussian},
    Choice<PixelFilter>{"blackmanHarris", PixelFilter::blackmanHarris},
};
inline constexpr std::array kSamplerChoices{
    Choice<Sampler>{"random", Sampler::random},
    Choice<Sampler>{"stratified", Sampler::stratified},
    Choice<Sampler>{"sobol", Sampler::sobol},
};
inline constexpr std::array kDirectionSamplingChoices{
    Choice<DirectionSampling>{"bsdf", DirectionSampling::bsdf},
    Choice<DirectionSampling>{"cosine", DirectionSampling::cosine},
    Choice<DirectionSampling>{"uniform", DirectionSampling::uniform},
};
inline constexpr std::array kRouletteChoices{
    Choice<RouletteRule>{"throughput", RouletteRule::throughput},
    Choice<RouletteRule>{"constant", RouletteRule::constant},
    Choice<RouletteRule>{"none", RouletteRule::none},
};
inline constexpr std::array kCameraFitChoices{
    Choice<CameraFit>{"vertical", CameraFit::vertical},
    Choice<CameraFit>{"horizontal", CameraFit::horizontal},
    Choice<CameraFit>{"fit", CameraFit::fit},
    Choice<CameraFit>{"fill", CameraFit::fill},
};
inline constexpr std::array kCullingChoices{
    Choice<Culling>{"none", Culling::none},
    Choice<Culling>{"camera", Culling::camera},
    Choice<Culling>{"all", Culling::all},
};
inline constexpr uint32_t kMostShutterSteps = 32;

template <typename Visitor>
void describe(Visitor& v, Is<ViewSettings> auto& view) {
    v.choice({"kind", "scene: the camera that the job names; else one placed here"}, view.kind, kViewChoices);
    v.triple({"eye", "m, where the camera is"}, view.eye, kCoordinate);
    v.triple({"target", "m, the middle of the picture"}, view.target, kCoordinate);
    v.triple({"up", "what is up in the picture"}, view.up, kCoordinate);
    v.number({"yfov", "degrees, perspective: the full vertical angle"}, view.yfov, {0.001, 179.5});
    v.number({"height", "m, orthographic: what the picture's height shows"}, view.height, kSize);
    v.number({"apertureRadius", "m, of the lens; 0 is a pinhole"}, view.apertureRadius, {0, 1e6});
    v.number({"fNumber", "the aperture by the focal length instead; 0 for none"}, view.fNumber, {0, 1000});
    v.number({"sensorWidth", "m, for the focal length"}, view.sensorWidth, {1e-4, 10});
    v.number({"focusDistance", "m; 0: to the target, or to the scene's middle from its own camera"},
             view.focusDistance, {0, 1e9});
    v.integer({"blades", "sides of the aperture; 0 or 3 to 64, 0 is a circle"}, view.blades, {0, 64});
    v.number({"bladeRotation", "degrees"}, view.bladeRotation, kTurn);
}

template <typename Visitor>
void describe(Visitor& v, Is<MotionSettings> auto& motion) {
    v.number({"fps", "frames a second: frame f shows the time f / fps"}, motion.fps, {0.001, 100000});
    v.text({"animation", "of the glTF file: all, none or one by name"}, motion.animation, {1, 1024});
    v.flag({"loop", "animations start again at their end, else they stay there"}, motion.loop);
    v.number({"turntable",
              "orbit of the camera around the scene's centre in degrees per frame, counter-clockwise seen "
              "from above (+y); 360 / frames for a full turn"},
             motion.turntable, kTurn);
    v.number({"shutter", "share of the frame's time that the shutter is open: 0 no blur, 0.5 as 180 degrees"},
             motion.shutter, {0, 1});
    v.integer({"shutterSteps",
               "scene snapshots per exposure where the scene moves, a power of two; biased (the camera alone "
               "moves without steps)"},
              motion.shutterSteps, {1, kMostShutterSteps});
}

}  // namespace tilefarm
