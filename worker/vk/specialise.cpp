#include "worker/vk/specialise.h"

#include <fmt/core.h>
#include <spirv-tools/libspirv.h>

#include <cstring>
#include <spirv-tools/optimizer.hpp>
#include <unordered_map>

namespace tilefarm::gpu {

namespace {

// All that a specialised module depends on: the passes below, the library that runs them, constants, input.
std::vector<std::byte> keyOf(std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
    const std::string version =
        fmt::format("{} {} {} ", TILEFARM_SPECIALISE_SOURCE, spvSoftwareVersionString(), constants.size());
    std::vector<std::byte> key;
    for (const auto part :
         {std::as_bytes(std::span(version)), std::as_bytes(std::span(constants)), std::as_bytes(spirv)})
        key.insert(key.end(), part.begin(), part.end());
    return key;
}

}  // namespace

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

std::vector<uint32_t> specialisedOnce(const ComputedCache& cache, std::span<const uint32_t> spirv,
                                      const std::vector<uint32_t>& constants) {
    const std::vector<std::byte> bytes = computedOnce(cache, "module", keyOf(spirv, constants), [&] {
        const std::vector<uint32_t> module = specialised(spirv, constants);
        const auto made = std::as_bytes(std::span(module));
        return std::vector<std::byte>(made.begin(), made.end());
    });
    std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
    std::memcpy(words.data(), bytes.data(), words.size() * sizeof(uint32_t));
    return words;
}

}  // namespace tilefarm::gpu
