#include "worker/render/raster_pass.h"

#include <algorithm>
#include <limits>
#include <set>

#include "raster.frag.h"
#include "raster.vert.h"
#include "raster_shapes.frag.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr uint32_t kBoxVertices = 36;

uint32_t columnsOf(uint32_t pixels) {
    return (pixels + gpu::RASTER_BLOCK - 1) / gpu::RASTER_BLOCK;
}

}  // namespace

RasterPass::RasterPass(const gpu::Device& device, const ImageSpec& image)
    : columns_(columnsOf(image.width)),
      target_(device, std::min(image.width, gpu::RASTER_BLOCK), std::min(image.height, gpu::RASTER_BLOCK),
              "visibility image"),
      visibility_(device, target_.bytes(), "visibility") {}

void RasterPass::compile(const gpu::Device& device, const std::vector<uint32_t>& constants, bool shapes) {
    gpu::PipelineSpec spec;
    spec.spirv = raster_vert;
    spec.bindings.assign(gpu::BINDING_SHAPE_SLOTS + 1, gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    spec.constants = constants;
    spec.pushConstantBytes = sizeof(gpu::PassConstants);
    spec.name = "raster";
    const std::span<const uint32_t> fragment =
        shapes ? std::span<const uint32_t>(raster_shapes_frag) : std::span<const uint32_t>(raster_frag);
    pipeline_.emplace(device, spec, fragment);
}

void RasterPass::setTiles(std::span<const Rect> tiles) {
    std::set<uint32_t> blocks;
    for (const Rect& tile : tiles)
        for (uint32_t y = tile.y / gpu::RASTER_BLOCK; y < columnsOf(tile.y + tile.height); ++y)
            for (uint32_t x = tile.x / gpu::RASTER_BLOCK; x < columnsOf(tile.x + tile.width); ++x)
                blocks.insert(y * columns_ + x);
    blocks_.assign(blocks.begin(), blocks.end());
}

void RasterPass::add(gpu::CommandRun& run, const gpu::ComputePipeline& shade,
                     const std::vector<gpu::Binding>& bindings, const gpu::PassConstants& constants,
                     uint32_t vertices, uint32_t groups, uint32_t tiles) const {
    gpu::PassConstants one = constants;
    one.sampleCount = std::min(constants.sampleCount, 1u);
    // A run of no samples still compiles: drivers do so on first use.
    for (uint32_t i = 0; i < std::max(constants.sampleCount, 1u); ++i) {
        one.firstSample = constants.firstSample + i * constants.sampleStride;
        one.continued = constants.continued | static_cast<uint32_t>(i > 0);
        for (const uint32_t block : blocks_) {
            one.block = block;
            const auto push = gpu::bytesOfValue(one);
            run.draw(*pipeline_, target_, visibility_, bindings, push, vertices, gpu::NO_INDEX);
            run.dispatch(shade, bindings, push, groups, groups, tiles);
        }
    }
}

std::vector<uint32_t> shapeSlotTable(uint32_t slots, const std::vector<uint32_t>& shapeSlots) {
    std::vector<uint32_t> table{3 * slots};
    table.insert(table.end(), shapeSlots.begin(), shapeSlots.end());
    return table;
}

uint32_t verticesOf(uint32_t slots, size_t shapes) {
    const uint64_t vertices = 3 * uint64_t{slots} + kBoxVertices * uint64_t{shapes};
    if (vertices > std::numeric_limits<int32_t>::max())
        throw Error(ErrorCode::unprocessable,
                    "the scene has more surfaces than the raster integrator can draw");
    return static_cast<uint32_t>(vertices);
}

}  // namespace tilefarm
