#pragma once

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"

namespace tilefarm {

/// Fills what says where samples lie: the pixel filter and the sampler.
void setSampling(gpu::FrameParameters& parameters, const RenderSettings& settings);

/// The FEATURE_* that they call for.
uint64_t samplingFeatures(const RenderSettings& settings);

/// Radius in pixels that the settings ask for, or the usual one of their filter.
double filterRadiusOf(const RenderSettings& settings);

/// Which of `steps` parts of the shutter's time a sample belongs to, by its index modulo `steps`, a power of
/// two: a van der Corput order, so that any run of samples covers the time evenly, shifted by seed and frame
/// at random, so that even a few samples favour no moment on average.
uint32_t shutterStep(uint32_t sample, uint32_t steps, uint32_t seed, int32_t frame);

}  // namespace tilefarm
