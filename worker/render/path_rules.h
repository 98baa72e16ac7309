#pragma once

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"

namespace tilefarm {

/// Fills what says how paths go on, end and are bounded.
void setPathRules(gpu::FrameParameters& parameters, const RenderSettings& settings);

/// The FEATURE_* that the rules call for; the usual ones call for none.
uint64_t pathRuleFeatures(const RenderSettings& settings);

}  // namespace tilefarm
