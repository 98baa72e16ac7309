#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace tilefarm {

enum class ViewKind : uint8_t {
    scene,  // the scene's camera that the job names
    perspective,
    orthographic,
    panorama,  // every direction, equirectangular
};

/// A camera that a job places itself, and the lens of any.
struct ViewSettings {
    ViewKind kind = ViewKind::scene;
    std::array<double, 3> eye{0, 0, 1};     // m
    std::array<double, 3> target{0, 0, 0};  // m: the middle of the picture
    std::array<double, 3> up{0, 1, 0};
    double yfov = 40;            // degrees, perspective: full vertical angle
    double height = 2;           // m, orthographic: what the picture's height shows
    double apertureRadius = 0;   // m; 0: a pinhole
    double fNumber = 0;          // gives the aperture by the focal length instead; 0: not used
    double sensorWidth = 0.036;  // m, for the focal length
    double focusDistance = 0;    // m along the view direction; 0: to the target, else to the scene's middle
    uint32_t blades = 0;         // sides of the aperture; 0: a circle
    double bladeRotation = 0;    // degrees
    friend bool operator==(const ViewSettings&, const ViewSettings&) = default;
};

/// How a frame's number becomes a moment, and what moves. Frame f shows the time f / fps on; while the
/// shutter is open, from then on for `shutter` / fps.
struct MotionSettings {
    double fps = 24;
    std::string animation = "all";  // of the glTF file: "all", "none" or one by name
    bool loop = false;              // animations start again at their end, else they stay there
    double turntable = 0;       // degrees a frame that the camera goes round the scene's middle, around +y
    double shutter = 0;         // of the frame's time: 0 no blur, 0.5 a shutter of 180°
    uint32_t shutterSteps = 8;  // moments that stand for the shutter where the scene moves: a power of two
    friend bool operator==(const MotionSettings&, const MotionSettings&) = default;
};

/// How a camera ray becomes a colour. All but `path` are biased; the views show what the first surface is.
enum class Integrator : uint8_t {
    path,
    whitted,           // mirrors and refraction, Phong shading, hard shadows of lights in their middle
    raster,            // drawn by the graphics pipeline: direct light, no shadows
    ambientOcclusion,  // share of the hemisphere that nothing hides within aoDistance
    albedo,
    normal,
    geometricNormal,
    depth,
    uv,
    material,
    object,
};

/// How the view that a file's camera frames lies in a picture of another aspect. What does not fill it is the
/// scene beyond the frame, never bars.
enum class CameraFit : uint8_t {
    vertical,    // the heights are one; the picture's aspect decides the width
    horizontal,  // the widths are one
    fit,         // whichever of the two shows the whole view
    fill,        // whichever shows nothing beyond it
};

/// Which rays pass through the back faces of materials that are not double-sided (glTF 2.0, 3.9.6).
enum class Culling : uint8_t {
    none,
    camera,  // rays from the camera to the first surface
    all,     // every ray, those to lights too
};

/// How samples are spread over a pixel; each keeps the mean of the picture that its filter defines.
enum class PixelFilter : uint8_t { box, tent, gaussian, blackmanHarris };

enum class Sampler : uint8_t { random, stratified, sobol };

/// How a path's next direction is drawn where it does not meet a mirror. All have the same mean.
enum class DirectionSampling : uint8_t {
    bsdf,     // in proportion to what the surface scatters
    cosine,   // in proportion to the cosine, on both sides where light passes
    uniform,  // over the whole sphere
};

/// Which paths end at random. All have the same mean.
enum class RouletteRule : uint8_t {
    throughput,  // one survives with the probability of what it still carries
    constant,    // with one that is the same for all
    none,        // all go on to the bounce limit
};

}  // namespace tilefarm
