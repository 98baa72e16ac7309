#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "worker/vk/device.h"

namespace tilefarm::gpu {

struct PipelineState;  // context.h

enum class BindingKind {
    texels,   // uniform samplerBuffer / usamplerBuffer
    storage,  // buffer block
    uniform,  // uniform block
};

struct PipelineSpec {
    std::span<const uint32_t> spirv;       // entry point "main"
    std::vector<BindingKind> bindings;     // binding i of set 0 is bindings[i]
    std::vector<uint32_t> constants = {};  // the specialization constant of id i has the bits constants[i]
    uint32_t pushConstantBytes = 0;        // at most 128, a multiple of 4
    std::string name = {};                 // for messages
};

/// A compute kernel, specialised and compiled. A handle: copies share the pipeline.
class ComputePipeline {
public:
    /// Throws Error(unprocessable) if it takes more bindings than the device has.
    ComputePipeline(const Device& device, const PipelineSpec& spec);
    const std::shared_ptr<const PipelineState>& state() const { return state_; }

private:
    std::shared_ptr<const PipelineState> state_;
};

}  // namespace tilefarm::gpu
