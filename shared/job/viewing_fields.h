#pragma once

// Part of the table in fields.h: cameras, motion, and the choices of sampling.

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
    v.choice({"kind",
              "scene: the file's camera that camera names; else a camera of this kind placed by eye, target "
              "and up"},
             view.kind, kViewChoices);
    v.triple({"eye", "position of the camera, m"}, view.eye, kCoordinate);
    v.triple({"target", "point that the camera looks at, m"}, view.target, kCoordinate);
    v.triple({"up", "direction that points up in the picture"}, view.up, kCoordinate);
    v.number({"yfov", "full vertical field of view of a perspective camera, degrees"}, view.yfov,
             {0.001, 179.5});
    v.number({"height", "height of an orthographic camera's view, m"}, view.height, kSize);
    v.number(
        {"apertureRadius", "radius of a perspective camera's lens, m; 0 is a pinhole: no depth of field"},
        view.apertureRadius, {0, 1e6});
    v.number({"fNumber", "f-number of the lens in place of apertureRadius; 0: not used"}, view.fNumber,
             {0, 1000});
    v.number({"sensorWidth",
              "width of the sensor, m; with the field of view it gives the focal length for fNumber"},
             view.sensorWidth, {1e-4, 10});
    v.number({"focusDistance",
              "distance of the plane in focus along the view direction, m; 0: distance to target, or to the "
              "scene's centre for a camera of the file"},
             view.focusDistance, {0, 1e9});
    v.integer({"blades", "blades of the aperture, which shape the bokeh: 3 to 64, or 0 for a circle"},
              view.blades, {0, 64});
    v.number({"bladeRotation", "rotation of the aperture blades, degrees"}, view.bladeRotation, kTurn);
}

template <typename Visitor>
void describe(Visitor& v, Is<MotionSettings> auto& motion) {
    v.number({"fps", "frames per second: frame f shows the animation at f / fps seconds"}, motion.fps,
             {0.001, 100000});
    v.text({"animation", "which animations of the file play: all, none, or the name of one"},
           motion.animation, {1, 1024});
    v.flag({"loop", "animations repeat; off: they hold their last key"}, motion.loop);
    v.number({"turntable",
              "orbit of the camera around the scene's centre in degrees per frame, counter-clockwise seen "
              "from above (+y); 360 / frames for a full turn"},
             motion.turntable, kTurn);
    v.number({"shutter",
              "fraction of the frame time that the shutter is open, from the frame's start: 0 no motion "
              "blur, 0.5 a 180 degree shutter"},
             motion.shutter, {0, 1});
    v.integer({"shutterSteps",
               "scene snapshots per exposure, a power of two: motion blur of moving objects is stepped and "
               "thereby biased; camera motion is continuous"},
              motion.shutterSteps, {1, kMostShutterSteps});
}

}  // namespace tilefarm
