#pragma once

#include <filesystem>

#include "shared/job/job.h"
#include "worker/agent/render_backend.h"

namespace tilefarm {

/// Every file that a scene on this disk is made of with its digest: the .gltf or .glb, the buffers and
/// images it names, the environment (empty: none). Paths are relative to the scene's folder, or to one above
/// it where the scene names a file there; the environment goes by "environment/" and its file name. What is
/// not there, or no file that a scene may name (shared/job/bundle_paths.h), is left out: the loader knows
/// whether it is needed. Throws Error that names the file and the fault, if `strict` also of these.
SceneBundle bundleOf(const SceneFiles& files, bool strict = false);

}  // namespace tilefarm
