#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shared/job/image_spec.h"
#include "shared/job/render_settings.h"
#include "worker/scene/scene.h"

namespace tilefarm::bench {

struct HostStats {
    uint64_t samples = 0;  // camera paths
    uint64_t rays = 0;     // closest-hit and shadow rays
};

/// Path tracer on the host over Embree, the yardstick of the benchmark. Lambert surfaces with constant
/// base colour; emissive triangles sampled by power; multiple importance sampling of light and BSDF with
/// the power heuristic; no Russian roulette: the estimator of the renderer for such a scene with
/// rouletteStart >= maxBounces. One ray at a time (rtcIntersect1, rtcOccluded1), one thread per core.
class EmbreePathTracer {
public:
    /// Builds Embree's BVH at its default quality. Looks only at colour, emission and geometry of `scene`.
    EmbreePathTracer(const Scene& scene, const Camera& camera, const ImageSpec& image,
                     const RenderSettings& settings);
    ~EmbreePathTracer();

    /// Adds `samples` samples to every pixel.
    void render(uint32_t samples);

    const HostStats& stats() const;
    double buildSeconds() const;
    unsigned threads() const;
    /// Mean radiance over the image so far, averaged over the three channels: to compare with the renderer's.
    double meanRadiance() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm::bench
