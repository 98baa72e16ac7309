#include "tests/shader/light_probe_runner.h"

#include <algorithm>
#include <cstring>

#include "light_probe.comp.h"
#include "worker/vk/commands.h"

namespace tilefarm {

LightProbe::LightProbe(const gpu::Device& device, const Scene& scene, const RenderSettings& settings)
    : LightProbe(device, scene, flatten(scene), settings) {}

LightProbe::LightProbe(const gpu::Device& device, const Scene& scene, const WorldGeometry& world,
                       const RenderSettings& settings)
    : device_(device),
      centre_(world.centre),
      scene_(makeGpuScene(device, scene, world, settings, 0, times_)),
      pipeline_(makePipeline()) {}

gpu::ComputePipeline LightProbe::makePipeline() const {
    gpu::PipelineSpec spec;
    spec.spirv = light_probe_comp;
    spec.bindings.assign(gpu::BINDING_COUNTERS + 1, gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    spec.constants.resize(gpu::SPEC_COUNT);
    spec.constants[gpu::SPEC_FEATURES] = static_cast<uint32_t>(scene_.features);
    spec.constants[gpu::SPEC_FEATURES_HIGH] = static_cast<uint32_t>(scene_.features >> 32);
    spec.constants[gpu::SPEC_VERTEX_TEXELS] = scene_.vertexTexels;
    spec.constants[gpu::SPEC_STACK_SIZE] = scene_.stackSize;
    spec.pushConstantBytes = sizeof(uint32_t);
    spec.name = "light_probe";
    return {device_, spec};
}

std::vector<LightAnswer> LightProbe::ask(std::vector<LightQuery> queries) {
    for (LightQuery& q : queries) q.position -= glm::vec4(glm::vec3(centre_), 0);
    const auto count = static_cast<uint32_t>(queries.size());
    gpu::FrameParameters parameters{};
    setLights(parameters, scene_);
    gpu::StorageBuffer frame(device_, sizeof parameters, "parameters"), unused(device_, 16, "unused"),
        in(device_, sizeof(LightQuery) * count, "queries"), out(device_, sizeof(LightAnswer) * count, "answers");
    frame.upload(gpu::bytesOfValue(parameters));
    in.upload(gpu::bytesOf(queries));
    std::vector<gpu::Binding> bindings(scene_.buffers.begin(), scene_.buffers.end());
    bindings.insert(bindings.end(), {frame, in, out, unused});
    gpu::CommandRun run(device_);
    run.dispatch(pipeline_, bindings, gpu::bytesOfValue(count), (count + 63) / 64);
    const size_t index = run.read(out);
    gpu::Submission submission = run.submit();
    std::vector<LightAnswer> answers(count);
    std::memcpy(answers.data(), submission.bytes(index).data(), sizeof(LightAnswer) * count);
    return answers;
}

}  // namespace tilefarm
