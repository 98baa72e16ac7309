#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "worker/cache_file/computed_cache.h"

namespace tilefarm::gpu {

/// The module with its specialization constants fixed (the one of id i to the bits constants[i]) and all that
/// they switch off removed. Drivers inline everything before they look at the constants: a kernel of many
/// effects takes lavapipe seconds where the ones in use take tenths. Empty if SPIRV-Tools cannot read the
/// module, which then goes to the driver as it is.
std::vector<uint32_t> specialised(std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants);

/// The same with the module kept from run to run: the passes take longer than a small job renders.
std::vector<uint32_t> specialisedOnce(const ComputedCache& cache, std::span<const uint32_t> spirv,
                                      const std::vector<uint32_t>& constants);

}  // namespace tilefarm::gpu
