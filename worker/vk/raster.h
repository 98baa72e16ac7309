#pragma once
// Drawing triangles into an image of integers: which surface each pixel sees. Free of Vulkan headers.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "worker/vk/pipeline.h"

namespace tilefarm::gpu {

struct TargetState;  // raster_state.h

/// Where draws go: four 32-bit integers per pixel and a depth, on the device.
class RasterTarget {
public:
    /// Throws Error(unprocessable) if the device draws nothing as large, or nothing at all
    /// (DeviceOptions::graphics).
    RasterTarget(const Device& device, uint32_t width, uint32_t height, const std::string& name);
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// Bytes of what CommandRun::draw copies out.
    uint64_t bytes() const { return uint64_t{16} * width_ * height_; }
    const std::shared_ptr<const TargetState>& state() const { return state_; }

private:
    uint32_t width_, height_;
    std::shared_ptr<const TargetState> state_;
};

/// A vertex and a fragment shader that draw a list of triangles, seen from both sides; the pixel keeps the
/// fragment of the greatest depth (reversed: 1 is near, 0 far). Vertices come from buffers by gl_VertexIndex.
/// The fragment shader writes a uvec4. A handle: copies share the pipeline.
class RasterPipeline {
public:
    /// `spec.spirv` is the vertex shader; both get all bindings and constants. Throws as ComputePipeline.
    RasterPipeline(const Device& device, const PipelineSpec& spec, std::span<const uint32_t> fragment);
    const std::shared_ptr<const PipelineState>& state() const { return state_; }

private:
    std::shared_ptr<const PipelineState> state_;
};

}  // namespace tilefarm::gpu
