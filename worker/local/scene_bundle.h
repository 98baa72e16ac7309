#pragma once

#include <filesystem>

#include "shared/job/job.h"
#include "worker/agent/render_backend.h"

namespace tilefarm {

/// Every file that a scene on this disk is made of with its digest: the .gltf or .glb, the buffers and
/// images it names, the environment (empty: none). Paths are relative to the scene's folder; the
/// environment goes by "environment/" and its file name. Throws Error that names the file and the fault, also if
/// the scene names a file that is not there.
SceneBundle bundleOf(const SceneFiles& files);

}  // namespace tilefarm
