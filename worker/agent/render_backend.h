#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "shared/error/error.h"
#include "shared/film/film.h"
#include "shared/job/job.h"
#include "worker/render/renderer.h"
#include "worker/scene/scene.h"

namespace tilefarm {

struct SceneFiles {
    std::filesystem::path entry;
    std::filesystem::path environment;  // empty: none
};

struct SceneCounts {
    uint64_t triangles = 0, instances = 0, materials = 0, images = 0, degenerateTriangles = 0,
             sanitisedTexels = 0;
    LightCounts lights;
};

/// What there is to say of a scene that has become resident.
struct PreparedScene {
    SceneCounts counts;
    std::vector<SceneWarning> warnings;
    FeatureReport features;
    double loadSeconds = 0;  // reading and decoding files
    PrepareTimes times;      // from there to the first pass
    double seconds() const {
        return loadSeconds + times.bvhSeconds + times.uploadSeconds + times.pipelineSeconds;
    }
};

struct DeviceName {
    std::string name, driver;
};

/// One device that holds at most one scene at a time. One thread at a time. A fake of it is in
/// tests/unit/worker/agent/fakes.h.
struct RenderBackend {
    virtual ~RenderBackend() = default;
    virtual DeviceName device() const = 0;
    /// Loads the scene that the job names and makes it resident, instead of the one before. Throws
    /// Error that names the file and the fault; nothing is resident then.
    virtual PreparedScene prepare(const JobSpec& spec, const SceneFiles& files) = 0;
    /// As Renderer::render.
    virtual std::vector<PassFilm> render(int32_t frame, std::span<const uint32_t> tiles,
                                         SampleRange samples) = 0;
    /// Sums over the calls of render() since prepare().
    virtual RenderStats stats() const = 0;
    /// As Renderer::trace, of the resident scene. Throws Error(unavailable) where the device cannot.
    virtual SampleTrace trace(int32_t, uint32_t, uint32_t, uint32_t) {
        throw Error(ErrorCode::unavailable, "this device traces no single samples");
    }
    /// Lets go of the scene.
    virtual void drop() = 0;
    /// After an error: lets go of the device too, which may be lost, and opens it anew when needed.
    virtual void reset() = 0;
};

}  // namespace tilefarm
