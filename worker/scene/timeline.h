#pragma once

#include <filesystem>
#include <memory>

#include "shared/job/job.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// What a job shows: its scene and its camera at any moment. All that is returned is a pure function of job,
/// frame and moment, whatever was asked for before. Throws as loadGltf and selectCamera do (load.h).
class Timeline {
public:
    /// `environment` may be empty. Lights, materials and environment that the job adds are in every scene.
    Timeline(const JobSpec& spec, const std::filesystem::path& entry,
             const std::filesystem::path& environment);
    ~Timeline();
    Timeline(Timeline&&) noexcept;

    /// Whether the scene differs between moments; a camera's moving does not count.
    bool moves() const;
    /// How many scenes stand for the time that a frame's shutter is open.
    uint32_t steps() const;
    /// Of the middle of one of these steps, good until the next call.
    Scene& scene(int32_t frame, uint32_t step);
    /// Frees the scene if no frame will need it again, being at rest; only camera() may be called then.
    void release();
    /// Of a frame, with its lens.
    CameraPath camera(int32_t frame);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
