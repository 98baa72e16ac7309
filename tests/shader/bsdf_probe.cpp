#include "tests/shader/bsdf_probe_runner.h"

#include <cstring>

#include "bsdf_probe.comp.h"
#include "shaders/gpu_types.h"
#include "worker/render/albedo_table.h"
#include "worker/vk/commands.h"

namespace tilefarm {

BsdfProbe::BsdfProbe(const gpu::Device& device, float ior)
    : device_(device), pipeline_(makePipeline(device)) {
    for (uint32_t binding = 0; binding < gpu::BINDING_PARAMETERS; ++binding) {
        const bool floats = binding == gpu::BINDING_TEXELS8 || binding == gpu::BINDING_TEXELS32 ||
                            binding == gpu::BINDING_ENVIRONMENT || binding == gpu::BINDING_ALBEDO_TABLES;
        std::vector<glm::vec4> data;
        if (binding == gpu::BINDING_ALBEDO_TABLES) data = buildAlbedoTable(ior);
        texels_.emplace_back(device, floats ? gpu::TexelFormat::rgba32f : gpu::TexelFormat::rgba32ui,
                             gpu::bytesOf(data), "probe");
    }
}

gpu::ComputePipeline BsdfProbe::makePipeline(const gpu::Device& device) {
    gpu::PipelineSpec spec;
    spec.spirv = bsdf_probe_comp;
    spec.bindings.assign(gpu::BINDING_COUNTERS + 1, gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    const uint64_t features =
        gpu::bit(gpu::FEATURE_SPECULAR) | gpu::bit(gpu::FEATURE_MIRROR) | gpu::bit(gpu::FEATURE_TRANSMISSION);
    spec.constants = {static_cast<uint32_t>(features), 1, 64, static_cast<uint32_t>(features >> 32)};
    spec.pushConstantBytes = sizeof(uint32_t);
    spec.name = "bsdf_probe";
    return {device, spec};
}

std::vector<BsdfAnswer> BsdfProbe::ask(const std::vector<BsdfQuery>& queries) {
    const auto count = static_cast<uint32_t>(queries.size());
    gpu::StorageBuffer unused(device_, 16, "unused"), in(device_, sizeof(BsdfQuery) * count, "queries"),
        out(device_, sizeof(BsdfAnswer) * count, "answers");
    in.upload(gpu::bytesOf(queries));
    std::vector<gpu::Binding> bindings(texels_.begin(), texels_.end());
    bindings.insert(bindings.end(), {unused, in, out, unused});
    gpu::CommandRun run(device_);
    run.dispatch(pipeline_, bindings, gpu::bytesOfValue(count), (count + 63) / 64);
    const size_t index = run.read(out);
    gpu::Submission submission = run.submit();
    std::vector<BsdfAnswer> answers(count);
    std::memcpy(answers.data(), submission.bytes(index).data(), sizeof(BsdfAnswer) * count);
    return answers;
}

}  // namespace tilefarm
