#include "tests/support/trace_kernel.h"

#include <algorithm>
#include <ctime>

#include "trace_rays.comp.h"

namespace tilefarm {
namespace {

using gpu::BindingKind;

gpu::ComputePipeline makePipeline(const gpu::Device& device, const Bvh& bvh, const TraceOptions& options) {
    return {device,
            {.spirv = options.spirv.empty() ? std::span<const uint32_t>(trace_rays_comp) : options.spirv,
             .bindings = {BindingKind::texels, BindingKind::texels, BindingKind::texels, BindingKind::storage,
                          BindingKind::texels},
             .constants = {bvhStackConstant(bvh), !options.nonOpaque.empty(), options.anyHit,
                           !options.shapes.empty()},
             .pushConstantBytes = 4,
             .name = "trace_rays"}};
}

double processorTime() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

TraceKernel::TraceKernel(const gpu::Device& device, std::span<const glm::vec3> corners,
                         const TraceOptions& options)
    : device_(device),
      bvh_(buildBvh(corners, options.nonOpaque, options.shapeBoxes)),
      pipeline_(makePipeline(device, bvh_, options)),
      nodes_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(bvh_.nodes), "BVH nodes"),
      triangles_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(bvh_.triangles), "BVH triangles"),
      shapes_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(options.shapes), "shapes") {}

std::vector<TracedHit> TraceKernel::trace(std::span<const TestRay> rays, int times) {
    std::vector<TracedHit> hits(rays.size());
    if (rays.empty()) return hits;
    const gpu::TexelBuffer input(device_, gpu::TexelFormat::rgba32ui, gpu::bytesOf(rays), "rays");
    const gpu::StorageBuffer output(device_, rays.size() * sizeof(TracedHit), "hits");
    gpu::CommandRun(device_).runAndWait();  // uploads are not part of the time
    const auto count = static_cast<uint32_t>(rays.size());
    const uint32_t groups = (count + 63) / 64, groupsX = std::min(groups, 1024u);
    gpu::CommandRun run(device_);
    for (int i = 0; i < times; ++i)
        run.dispatch(pipeline_, {nodes_, triangles_, input, output, shapes_}, gpu::bytesOfValue(count),
                     groupsX, (groups + groupsX - 1) / groupsX);
    const double start = processorTime();
    seconds_ = run.runAndWait() / times;
    processorSeconds_ = (processorTime() - start) / times;
    output.read(std::as_writable_bytes(std::span(hits)));
    return hits;
}

}  // namespace tilefarm
