#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/film/film.h"
#include "shared/job/job.h"
#include "worker/scene/scene.h"

namespace tilefarm::gpu {
class Device;
}

namespace tilefarm {

/// Why a pass or scene could be rendered the way it was; for reports.
struct FeatureReport {
    std::vector<std::string> used;     // effects that the kernel holds
    std::vector<std::string> leftOut;  // effects that the scene does not call for
};

struct RenderStats {
    double deviceSeconds = 0;  // device busy, by timestamps where the device has them
    uint64_t samples = 0;      // camera paths
    uint64_t rays = 0;         // closest-hit and shadow rays
    uint64_t droppedSamples = 0;
};

struct PrepareTimes {
    double bvhSeconds = 0, uploadSeconds = 0, pipelineSeconds = 0;
};

/// Renders passes of one scene on one device. The scene stays resident between calls. Not thread safe.
class Renderer {
public:
    /// Packs and uploads the scene, builds its BVH and the kernel with the effects it calls for.
    /// `camera` has been selected for the frame. Throws Error(invalidArgument | unprocessable) if the
    /// scene does not fit the device. `alsoCompiled`: FEATURE_* bits to compile in although nothing calls
    /// for them, which must not change a bit of the picture (tests/shader/feature_bits_test.cpp).
    Renderer(const gpu::Device& device, const Scene& scene, const Camera& camera, const ImageSpec& image,
             const RenderSettings& settings, uint64_t alsoCompiled = 0);
    ~Renderer();

    /// Films of the tiles `tiles` (indices in the TileGrid of the image) over `samples`, in the order
    /// given. A sample is a pure function of (scene, settings, frame, pixel, sample index).
    std::vector<PassFilm> render(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples);

    /// Sums over all calls so far.
    const RenderStats& stats() const;
    const FeatureReport& features() const;
    const PrepareTimes& prepareTimes() const;
    uint64_t triangleCount() const;
    /// FEATURE_* bits that the kernel holds.
    uint64_t featureBits() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
