#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shaders/gpu_types.h"
#include "shared/film/film.h"
#include "worker/vk/commands.h"

namespace tilefarm {

/// The drawing half of the raster integrator: which surface every pixel of a block of the image sees, in a
/// buffer that raster_shade.comp reads as BINDING_VISIBILITY.
class RasterPass {
public:
    /// Throws Error(unprocessable) if the device does not draw, or nothing as large.
    RasterPass(const gpu::Device& device, const ImageSpec& image);

    /// `constants`: the specialization constants of the scene's kernels. `shapes`: there are surfaces other
    /// than triangles.
    void compile(const gpu::Device& device, const std::vector<uint32_t>& constants, bool shapes);

    const gpu::StorageBuffer& visibility() const { return visibility_; }

    /// Says which tiles the next runs shade, hence which blocks are drawn.
    void setTiles(std::span<const Rect> tiles);

    /// Adds draws and shading of `constants.sampleCount` samples to a run, one after the other. `bindings` in
    /// the order of BINDING_*; `vertices` as verticesOf gives them.
    void add(gpu::CommandRun& run, const gpu::ComputePipeline& shade,
             const std::vector<gpu::Binding>& bindings, const gpu::PassConstants& constants,
             uint32_t vertices, uint32_t groups, uint32_t tiles) const;

private:
    uint32_t columns_;
    gpu::RasterTarget target_;
    gpu::StorageBuffer visibility_;
    std::optional<gpu::RasterPipeline> pipeline_;
    std::vector<uint32_t> blocks_{0};
};

/// What BINDING_SHAPE_SLOTS holds: `slots` triangles and shapes in the order of the BVH, and where the shapes
/// are among them.
std::vector<uint32_t> shapeSlotTable(uint32_t slots, const std::vector<uint32_t>& shapeSlots);

/// Vertices of a draw of such a scene.
uint32_t verticesOf(uint32_t slots, size_t shapes);

}  // namespace tilefarm
