#include "tests/shader/shape_probe.h"

#include <algorithm>

#include "shape_probe.comp.h"
#include "worker/render/shape_packer.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

WorldGeometry worldOf(std::vector<Shape> shapes) {
    Scene scene;
    scene.materials.emplace_back();
    scene.shapes = std::move(shapes);
    return flatten(scene);
}

Bvh bvhOf(const WorldGeometry& world, bool nonOpaque) {
    return buildBvh({}, std::vector<uint8_t>(world.shapes.size(), nonOpaque), shapeBoxes(world.shapes));
}

gpu::ComputePipeline makePipeline(const gpu::Device& device, const Bvh& bvh, bool nonOpaque, bool fields) {
    using gpu::BindingKind;
    return {device,
            {.spirv = shape_probe_comp,
             .bindings = {BindingKind::texels, BindingKind::texels, BindingKind::texels, BindingKind::storage,
                          BindingKind::texels},
             .constants = {bvhStackConstant(bvh), nonOpaque, fields},
             .pushConstantBytes = 4,
             .name = "shape_probe"}};
}

}  // namespace

Shape shapeOf(ShapeKind kind, const glm::dvec3& size) {
    Shape shape;
    shape.kind = kind;
    shape.size = size;
    return shape;
}

Shape fieldOf(std::vector<FieldInstruction> field) {
    Shape shape;
    shape.kind = ShapeKind::field;
    shape.field = std::move(field);
    return shape;
}

ShapeProbe::ShapeProbe(const gpu::Device& device, std::vector<Shape> shapes, bool nonOpaque)
    : device_(device),
      bvh_([&] {
          const WorldGeometry world = worldOf(std::move(shapes));
          centre_ = world.centre;
          for (const WorldShape& shape : world.shapes) fields_ |= shape.shape.kind == ShapeKind::field;
          records_ = packShapes(world.shapes);
          return bvhOf(world, nonOpaque);
      }()),
      pipeline_(makePipeline(device, bvh_, nonOpaque, fields_)),
      nodes_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(bvh_.nodes), "BVH nodes"),
      triangles_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(bvh_.triangles), "BVH triangles"),
      shapes_(device, gpu::TexelFormat::rgba32ui, gpu::bytesOf(records_), "shapes") {}

std::vector<ShapeHit> ShapeProbe::trace(std::span<const TestRay> rays) {
    std::vector<ShapeHit> hits(rays.size());
    const gpu::TexelBuffer input(device_, gpu::TexelFormat::rgba32ui, gpu::bytesOf(rays), "rays");
    const gpu::StorageBuffer output(device_, rays.size() * sizeof(ShapeHit), "hits");
    const auto count = static_cast<uint32_t>(rays.size());
    const uint32_t groups = (count + 63) / 64, groupsX = std::min(groups, 1024u);
    gpu::CommandRun run(device_);
    run.dispatch(pipeline_, {nodes_, triangles_, input, output, shapes_}, gpu::bytesOfValue(count), groupsX,
                 (groups + groupsX - 1) / groupsX);
    run.runAndWait();
    output.read(std::as_writable_bytes(std::span(hits)));
    return hits;
}

}  // namespace tilefarm
