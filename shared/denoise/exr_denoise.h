#pragma once

#include <filesystem>

#include "shared/denoise/denoise.h"

namespace tilefarm {

/// Writes a frame's EXR again with everything it has, bit for bit, and with the channels denoised.R,
/// denoised.G and denoised.B and the attribute "tilefarm.denoiser" (denoiserText). Some rows at a time, so
/// memory holds a band and not the frame. `out` is whole or absent, and may be `in`.
/// Throws Error(invalidArgument) that names `in` and its fault, with every channel that is missing, or
/// Error(outOfSpace | internal) that names `out`.
void denoiseExr(const std::filesystem::path& in, const std::filesystem::path& out,
                const DenoiseSettings& settings);

}  // namespace tilefarm
