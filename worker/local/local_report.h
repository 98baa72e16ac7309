#pragma once

#include <nlohmann/json_fwd.hpp>

#include "shared/image/exr.h"
#include "worker/local/frame_render.h"

namespace tilefarm {

/// All that is known of a local render, for people and for studies of accuracy against time.
nlohmann::json localReport(const JobSpec& spec, const DeviceName& device, const PreparedScene& scene,
                           const RenderedFrame& frame);

/// Attributes of the EXR, named as the server names its own; the job is "local".
ImageAttributes localAttributes(const JobSpec& spec, const DeviceName& device, const RenderedFrame& frame);

}  // namespace tilefarm
