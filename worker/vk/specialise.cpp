#include "worker/vk/specialise.h"

#include <spirv-tools/optimizer.hpp>
#include <unordered_map>

namespace tilefarm::gpu {

std::vector<uint32_t> specialised(std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
    std::unordered_map<uint32_t, std::vector<uint32_t>> values;
    for (uint32_t id = 0; id < constants.size(); ++id) values[id] = {constants[id]};
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
    optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values))
        .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
        .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
        // Branches on features alone go first: the passes after this one, the slow ones, then read what is
        // left.
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
        .RegisterPass(spvtools::CreateCCPPass())
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
        .RegisterPass(spvtools::CreateAggressiveDCEPass());
    // glslang's output needs no second look, which would cost as much as the passes.
    spvtools::OptimizerOptions options;
    options.set_run_validator(false);
    std::vector<uint32_t> result;
    if (!optimizer.Run(spirv.data(), spirv.size(), &result, options)) return {};
    return result;
}

}  // namespace tilefarm::gpu
