#pragma once

#include <cstdint>
#include <memory>

#include "worker/agent/render_backend.h"
#include "worker/vk/device.h"

namespace tilefarm {

/// RenderBackend on a Vulkan device; `forcedFeatures` as for Renderer. Throws as gpu::Device does.
std::unique_ptr<RenderBackend> makeDeviceBackend(uint32_t device, gpu::DeviceOptions options = {},
                                                 uint64_t forcedFeatures = 0);

}  // namespace tilefarm
