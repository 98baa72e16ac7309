#include "worker/vk/pipeline.h"

#include <fmt/core.h>

#include <algorithm>

#include "worker/vk/context.h"
#include "worker/vk/enumerate.h"
#include "worker/vk/pipeline_parts.h"
#include "worker/vk/specialise.h"

namespace tilefarm::gpu {
namespace {

constexpr uint32_t kMaxPushConstantBytes = 128;  // what every device has

vk::DescriptorType descriptorType(BindingKind kind) {
    switch (kind) {
        case BindingKind::texels: return vk::DescriptorType::eUniformTexelBuffer;
        case BindingKind::storage: return vk::DescriptorType::eStorageBuffer;
        case BindingKind::uniform: return vk::DescriptorType::eUniformBuffer;
    }
    throw Error(ErrorCode::invalidArgument, "Unknown kind of binding");
}

void checkCount(const PipelineSpec& spec, BindingKind kind, const char* what, uint32_t limit) {
    const auto count = std::count(spec.bindings.begin(), spec.bindings.end(), kind);
    if (count > limit)
        throw Error(ErrorCode::unprocessable, fmt::format("Kernel '{}' binds {} {}, the device allows {}",
                                                          spec.name, count, what, limit));
}

void check(const Device& device, const PipelineSpec& spec) {
    checkCount(spec, BindingKind::texels, "texel buffers", device.limits().texelBuffers);
    checkCount(spec, BindingKind::storage, "storage buffers", device.limits().storageBuffers);
    if (spec.pushConstantBytes > kMaxPushConstantBytes || spec.pushConstantBytes % 4 != 0)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("Kernel '{}' has {} bytes of push constants; at most {}, in "
                                "whole words, are allowed",
                                spec.name, spec.pushConstantBytes, kMaxPushConstantBytes));
}

void makeLayout(const Device::Context& context, const PipelineSpec& spec, vk::ShaderStageFlags stages,
                PipelineState& state) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < spec.bindings.size(); ++i)
        bindings.emplace_back(i, descriptorType(spec.bindings[i]), 1, stages);
    state.setLayout =
        vk::raii::DescriptorSetLayout(context.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
    const vk::PushConstantRange range(stages, 0, spec.pushConstantBytes);
    vk::PipelineLayoutCreateInfo info({}, *state.setLayout);
    if (spec.pushConstantBytes) info.setPushConstantRanges(range);
    state.layout = vk::raii::PipelineLayout(context.device, info);
}

}  // namespace

StageConstants::StageConstants(const std::vector<uint32_t>& values) {
    for (uint32_t id = 0; id < values.size(); ++id) entries_.emplace_back(id, id * 4, 4);
    info_ = vk::SpecializationInfo(static_cast<uint32_t>(entries_.size()), entries_.data(), values.size() * 4,
                                   values.data());
}

vk::raii::ShaderModule shaderModule(const Device::Context& context, std::span<const uint32_t> spirv,
                                    const std::vector<uint32_t>& constants) {
    const std::vector<uint32_t> smaller = specialisedOnce({shaderCacheFolder()}, spirv, constants);
    if (!smaller.empty()) spirv = smaller;
    return {context.device, vk::ShaderModuleCreateInfo({}, spirv.size_bytes(), spirv.data())};
}

std::shared_ptr<PipelineState> startPipeline(const Device& device, const PipelineSpec& spec,
                                             vk::ShaderStageFlags stages) {
    check(device, spec);
    auto state = std::make_shared<PipelineState>();
    state->name = spec.name;
    state->kinds = spec.bindings;
    state->stages = stages;
    state->pushConstantBytes = spec.pushConstantBytes;
    makeLayout(device.context(), spec, stages, *state);
    return state;
}

ComputePipeline::ComputePipeline(const Device& device, const PipelineSpec& spec) {
    Device::Context& context = device.context();
    state_ = guarded(context, fmt::format("compiling kernel '{}'", spec.name), [&] {
        auto state = startPipeline(device, spec, vk::ShaderStageFlagBits::eCompute);
        const StageConstants constants(spec.constants);
        const auto module = shaderModule(context, spec.spirv, spec.constants);
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                      &constants.info());
        state->pipeline = vk::raii::Pipeline(context.device, context.pipelineCache,
                                             vk::ComputePipelineCreateInfo({}, stage, *state->layout));
        context.savePipelineCache();
        return state;
    });
}

}  // namespace tilefarm::gpu
