#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/film/film.h"
#include "shared/job/image_spec.h"
#include "shared/job/render_settings.h"
#include "worker/render/light_counts.h"
#include "worker/scene/scene.h"

namespace tilefarm::gpu {
class Device;
}

namespace tilefarm {

/// Why a pass or scene could be rendered the way it was; for reports.
struct FeatureReport {
    std::vector<std::string> used;      // effects that the kernel holds
    std::vector<std::string> leftOut;   // effects that the scene does not call for
    std::vector<std::string> notShown;  // effects that it calls for and the integrator does not know
};

struct RenderStats {
    double deviceSeconds = 0;  // device busy, by timestamps where the device has them
    uint64_t samples = 0;      // camera paths
    uint64_t rays = 0;         // closest-hit and shadow rays
    uint64_t droppedSamples = 0;
    PassFaults faults{};
};

/// One step of a path as Renderer::trace saw it.
struct TraceStep {
    glm::vec3 position{
        0};       // where it met a surface or fog scattered it; of a ray that left the scene its direction
    float t = 0;  // along the ray; infinite for one that left
    glm::vec3 throughput{0};
    float pdf = 0;           // of the direction that led here, 1/sr
    glm::vec3 radiance{0};   // gathered up to here, light that this surface emits included
    uint32_t primitive = 0;  // kNone: of fog, or where t is infinite none
};

struct SampleTrace {
    glm::vec3 radiance{0};  // of the sample; NaN or infinite for one that a render drops
    std::vector<TraceStep> steps;
};

struct PrepareTimes {
    double bvhSeconds = 0, uploadSeconds = 0, pipelineSeconds = 0;
};

/// Renders passes of one scene on one device. The scene stays resident between calls. Not thread safe.
class Renderer {
public:
    /// Packs and uploads the scene, builds its BVH and the kernel with the effects it calls for.
    /// `camera` has been selected for the frame. Throws Error(invalidArgument | unprocessable) if the
    /// scene does not fit the device. `channels`: what films hold besides the picture. `forcedFeatures`:
    /// FEATURE_* bits to compile in although neither scene nor channels call for them, which must not change
    /// a bit of the picture (tests/shader/feature_bits_test.cpp).
    Renderer(const gpu::Device& device, const Scene& scene, const Camera& camera, const ImageSpec& image,
             const RenderSettings& settings, const FilmLayout& channels = {}, uint64_t forcedFeatures = 0);
    /// Likewise with a camera that moves while the shutter is open.
    Renderer(const gpu::Device& device, const Scene& scene, const CameraPath& camera, const ImageSpec& image,
             const RenderSettings& settings, const FilmLayout& channels = {}, uint64_t forcedFeatures = 0);
    ~Renderer();

    /// Moves the camera, and opens the shutter for as long as its path takes. Cheap: the scene stays as it
    /// is.
    void setCamera(const CameraPath& path);
    /// Replaces the scene by others with the same images and environment: those of the middles of `steps`
    /// equal parts of the shutter's time, a power of two, in the order of time. A sample belongs to one of
    /// them by its index. One step: the scene does not move while the shutter is open. Each is asked for when
    /// its turn comes.
    void setScenes(uint32_t steps, const std::function<const Scene&(uint32_t step)>& sceneOf);

    /// Films of the tiles `tiles` (indices in the TileGrid of the image) over `samples`, in the order
    /// given. A sample is a pure function of (scene, settings, frame, pixel, sample index).
    std::vector<PassFilm> render(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples);

    /// One sample of one pixel alone, step by step: for debugging. Throws Error(invalidArgument) unless
    /// FEATURE_TRACE was compiled in and the pixel is in the image.
    SampleTrace trace(int32_t frame, uint32_t x, uint32_t y, uint32_t sample);

    /// Sums over all calls so far.
    const RenderStats& stats() const;
    const FeatureReport& features() const;
    /// Of what the camera's first picture shows otherwise than the file says (view_warnings.h).
    const std::vector<SceneWarning>& warnings() const;
    const PrepareTimes& prepareTimes() const;
    uint64_t triangleCount() const;
    /// Left out although the scene names them: collapsed by a transform, or beyond a float.
    uint64_t degenerateTriangles() const;
    const LightCounts& lights() const;
    /// FEATURE_* bits that the kernel holds.
    uint64_t featureBits() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
