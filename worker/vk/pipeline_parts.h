#pragma once
// What compute and raster pipelines share. For worker/vk's sources only.

#include <memory>
#include <span>
#include <vector>

#include "worker/vk/context.h"

namespace tilefarm::gpu {

/// Specialization constants 0, 1, 2 … of one stage. Reads `values` as long as it lives.
class StageConstants {
public:
    explicit StageConstants(const std::vector<uint32_t>& values);
    StageConstants(const StageConstants&) = delete;
    StageConstants& operator=(const StageConstants&) = delete;
    const vk::SpecializationInfo& info() const { return info_; }

private:
    std::vector<vk::SpecializationMapEntry> entries_;
    vk::SpecializationInfo info_;
};

/// `constants`: values of the specialization constants, to leave out what they switch off.
vk::raii::ShaderModule shaderModule(const Device::Context& context, std::span<const uint32_t> spirv,
                                    const std::vector<uint32_t>& constants);

/// A pipeline that lacks nothing but its VkPipeline. Throws as ComputePipeline does.
std::shared_ptr<PipelineState> startPipeline(const Device& device, const PipelineSpec& spec,
                                             vk::ShaderStageFlags stages);

}  // namespace tilefarm::gpu
