#pragma once
// Buffers of a device, free of Vulkan headers. Handles: copies share the buffer, and a submission keeps the
// buffers that it uses. Uploads are collected in staging memory and travel with the next submission.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "worker/vk/device.h"

namespace tilefarm::gpu {

struct BufferState;  // context.h

enum class TexelFormat {
    rgba32f,     // samplerBuffer
    rgba32ui,    // usamplerBuffer; bits pass unchanged, whatever they mean as floats
    rgba16f,     // samplerBuffer
    rgba8unorm,  // samplerBuffer
};
size_t texelBytes(TexelFormat format);

/// Data that kernels only read, through a uniform texel buffer: the fastest load path on lavapipe, tied on
/// GPUs.
class TexelBuffer {
public:
    /// Uploads `texels`, a whole number of texels; no data gives one zero texel, so that what a scene
    /// lacks can be bound too. `name` is for messages. Throws Error(unprocessable) above the device's limit.
    TexelBuffer(const Device& device, TexelFormat format, std::span<const std::byte> texels,
                const std::string& name);
    uint64_t texels() const { return texels_; }
    const std::shared_ptr<const BufferState>& state() const { return state_; }

private:
    std::shared_ptr<const BufferState> state_;
    uint64_t texels_ = 0;
};

/// Device-local data that kernels read and write.
class StorageBuffer {
public:
    /// Starts as zeros. Throws Error(unprocessable) above the device's limit.
    StorageBuffer(const Device& device, uint64_t bytes, const std::string& name);
    /// Takes effect after what was submitted before and ahead of the next submission, as do all uploads.
    void zero();
    void upload(std::span<const std::byte> data, uint64_t offset = 0);
    /// Waits for everything submitted so far, then copies out.
    void read(std::span<std::byte> to, uint64_t offset = 0) const;
    uint64_t bytes() const { return bytes_; }
    const std::shared_ptr<const BufferState>& state() const { return state_; }

private:
    std::shared_ptr<const BufferState> state_;
    uint64_t bytes_ = 0;
};

/// Parameters of a dispatch, at most 16 KiB (what every device allows). An update never touches what
/// dispatches in flight read: it travels with the next submission, in order.
class UniformBuffer {
public:
    UniformBuffer(const Device& device, uint64_t bytes, const std::string& name);
    void update(std::span<const std::byte> data);
    uint64_t bytes() const { return bytes_; }
    const std::shared_ptr<const BufferState>& state() const { return state_; }

private:
    std::shared_ptr<const BufferState> state_;
    uint64_t bytes_ = 0;
};

/// Bytes of a vector or array of plain values.
template <typename T>
std::span<const std::byte> bytesOf(std::span<const T> values) {
    return std::as_bytes(values);
}
template <typename T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
    return std::as_bytes(std::span<const T>(values));
}
template <typename T>
std::span<const std::byte> bytesOfValue(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span<const T, 1>(&value, 1));
}

}  // namespace tilefarm::gpu
