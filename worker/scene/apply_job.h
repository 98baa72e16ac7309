#pragma once

#include <filesystem>

#include "worker/scene/gltf_source.h"

namespace tilefarm {

struct JobSpec;

/// The scene that a job renders, at time 0 (timeline.h: at any): its files, read with the job's variant, with what the job says of
/// materials, lights and environment laid over them, and light where there is none. `environment` may be
/// empty. Throws Error(invalidArgument) that names the file or the job's member and the fault.
Scene loadJobScene(const std::filesystem::path& entry, const std::filesystem::path& environment,
                   const JobSpec& job);

/// How a job wants its glTF file read.
GltfOptions gltfOptionsOf(const JobSpec& job);

/// Adds the job's lights. For each time of an animated scene.
void addJobLights(Scene& scene, const JobSpec& job);

/// Sets the job's environment, with the pixels of `file` where the job wants them (empty: there is none),
/// and light where there is none at all. Once for each scene, after its lights.
void setJobEnvironment(Scene& scene, const JobSpec& job, const std::filesystem::path& file);

/// Sets the job's fog. Once for each scene.
void setJobFog(Scene& scene, const JobSpec& job);

}  // namespace tilefarm
