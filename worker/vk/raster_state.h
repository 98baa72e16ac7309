#pragma once
// For worker/vk's sources only.

#include "worker/vk/context.h"

namespace tilefarm::gpu {

inline constexpr vk::Format kRasterColour = vk::Format::eR32G32B32A32Uint;
inline constexpr vk::Format kRasterDepth = vk::Format::eD32Sfloat;

struct TargetState {
    TargetState(const Device& device, vk::Extent2D extent, const std::string& name);

    vk::Extent2D size;
    AttachmentState colour, depth;
    vk::raii::RenderPass renderPass;  // compatible with the one of every RasterPipeline
    vk::raii::Framebuffer framebuffer;
};

/// Clears both attachments, keeps the colour for a copy.
vk::raii::RenderPass makeRasterPass(const Device::Context& context);

}  // namespace tilefarm::gpu
