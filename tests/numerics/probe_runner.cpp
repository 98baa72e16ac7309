#include "tests/numerics/probe_runner.h"

#include <algorithm>
#include <cstring>
#include <numbers>

#include "probe.comp.h"
#include "worker/vk/commands.h"

namespace tilefarm {
namespace {

GpuScene uploaded(const gpu::Device& device, Scene scene) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    PrepareTimes times;
    return makeGpuScene(device, scene, flatten(scene), RenderSettings{}, gpu::bit(gpu::FEATURE_ENVIRONMENT),
                        times);
}

gpu::ComputePipeline pipelineFor(const gpu::Device& device, const GpuScene& scene) {
    gpu::PipelineSpec spec;
    spec.spirv = probe_comp;
    spec.bindings.assign(gpu::BINDING_COUNTERS + 1, gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    spec.constants.resize(gpu::SPEC_COUNT);
    spec.constants[gpu::SPEC_FEATURES] = static_cast<uint32_t>(scene.features);
    spec.constants[gpu::SPEC_FEATURES_HIGH] = static_cast<uint32_t>(scene.features >> 32);
    spec.constants[gpu::SPEC_VERTEX_TEXELS] = scene.vertexTexels;
    spec.constants[gpu::SPEC_STACK_SIZE] = scene.stackSize;
    spec.pushConstantBytes = 2 * sizeof(uint32_t);
    spec.name = "numerics probe";
    return {device, spec};
}

gpu::FrameParameters parametersOf(const GpuScene& scene) {
    gpu::FrameParameters p{};
    p.environmentSize = {scene.environmentWidth, scene.environmentHeight};
    if (scene.environmentWeightSum > 0) {
        const double texels = double(scene.environmentWidth) * scene.environmentHeight;
        p.environmentInverseWeight = static_cast<float>(1 / scene.environmentWeightSum);
        p.environmentTexelsPerSteradian = static_cast<float>(texels / (2 * std::numbers::pi * std::numbers::pi));
    }
    return p;
}

}  // namespace

Probe::Probe(const gpu::Device& device, const Scene& scene)
    : device_(device), scene_(uploaded(device, scene)), pipeline_(pipelineFor(device, scene_)) {}

Probe::Answer Probe::run(uint32_t mode, uint32_t count, const std::vector<glm::vec4>& queries,
                         uint32_t valuesEach) {
    gpu::StorageBuffer parameters(device_, sizeof(gpu::FrameParameters), "parameters"),
        in(device_, std::max<uint64_t>(16, sizeof(glm::vec4) * queries.size()), "queries"),
        out(device_, std::max<uint64_t>(16, sizeof(glm::vec4) * count * valuesEach), "answers"),
        counters(device_, sizeof(uint32_t) * gpu::COUNTER_COUNT, "counters");
    parameters.upload(gpu::bytesOfValue(parametersOf(scene_)));
    if (!queries.empty()) in.upload(gpu::bytesOf(queries));
    std::vector<gpu::Binding> bindings(scene_.buffers.begin(), scene_.buffers.end());
    bindings.insert(bindings.end(), {parameters, in, out, counters});
    const std::vector<uint32_t> push{mode, count};
    const uint32_t groups = (count + 63) / 64, groupsX = std::min(groups, 1024u);
    gpu::CommandRun run(device_);
    run.dispatch(pipeline_, bindings, gpu::bytesOf(push), groupsX, (groups + groupsX - 1) / groupsX);
    run.runAndWait();
    Answer answer;
    answer.values.resize(size_t{count} * valuesEach);
    answer.counters.resize(gpu::COUNTER_COUNT);
    if (valuesEach > 0) out.read(std::as_writable_bytes(std::span(answer.values)));
    counters.read(std::as_writable_bytes(std::span(answer.counters)));
    return answer;
}

}  // namespace tilefarm
