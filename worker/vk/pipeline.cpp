#include "worker/vk/pipeline.h"

#include <fmt/core.h>

#include <algorithm>

#include "worker/vk/context.h"

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

void makeLayout(const Device::Context& context, const PipelineSpec& spec, PipelineState& state) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < spec.bindings.size(); ++i)
        bindings.emplace_back(i, descriptorType(spec.bindings[i]), 1, vk::ShaderStageFlagBits::eCompute);
    state.setLayout =
        vk::raii::DescriptorSetLayout(context.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
    const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, spec.pushConstantBytes);
    vk::PipelineLayoutCreateInfo info({}, *state.setLayout);
    if (spec.pushConstantBytes) info.setPushConstantRanges(range);
    state.layout = vk::raii::PipelineLayout(context.device, info);
}

void compile(const Device::Context& context, const PipelineSpec& spec, PipelineState& state) {
    std::vector<vk::SpecializationMapEntry> entries;
    for (uint32_t id = 0; id < spec.constants.size(); ++id) entries.emplace_back(id, id * 4, 4);
    const vk::SpecializationInfo constants(static_cast<uint32_t>(entries.size()), entries.data(),
                                           spec.constants.size() * 4, spec.constants.data());
    const vk::raii::ShaderModule module(
        context.device, vk::ShaderModuleCreateInfo({}, spec.spirv.size_bytes(), spec.spirv.data()));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                  &constants);
    state.pipeline = vk::raii::Pipeline(context.device, context.pipelineCache,
                                        vk::ComputePipelineCreateInfo({}, stage, *state.layout));
}

}  // namespace

ComputePipeline::ComputePipeline(const Device& device, const PipelineSpec& spec) {
    check(device, spec);
    Device::Context& context = device.context();
    state_ = guarded(context, fmt::format("compiling kernel '{}'", spec.name), [&] {
        auto state = std::make_shared<PipelineState>();
        state->name = spec.name;
        state->kinds = spec.bindings;
        state->pushConstantBytes = spec.pushConstantBytes;
        makeLayout(context, spec, *state);
        compile(context, spec, *state);
        context.savePipelineCache();
        return state;
    });
}

}  // namespace tilefarm::gpu
