#pragma once
// What everything on one device shares. The only header that includes Vulkan; only worker/vk's sources
// include it.

#include <mutex>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "shared/error/error.h"
#include "worker/vk/buffer.h"
#include "worker/vk/device.h"
#include "worker/vk/pipeline.h"

namespace tilefarm::gpu {

/// Where a buffer's memory lives.
enum class MemoryUse { device, upload, readback };

/// A buffer, its memory and, for host-visible use, its address. Members are declared in the order that
/// destroys a view before its buffer and a buffer before its memory.
struct BufferState {
    BufferState(Device::Context& owner, vk::DeviceSize size, vk::BufferUsageFlags usage, MemoryUse use,
                const std::string& bufferName);

    Device::Context& context;
    std::string name;
    vk::DeviceSize bytes;
    vk::raii::DeviceMemory memory = nullptr;
    vk::raii::Buffer buffer;
    vk::raii::BufferView view = nullptr;  // texel buffers
    std::byte* mapped = nullptr;
    bool coherent = true;
};

struct PipelineState {
    std::string name;
    std::vector<BindingKind> kinds;
    vk::ShaderStageFlags stages;
    uint32_t pushConstantBytes = 0;
    vk::raii::DescriptorSetLayout setLayout = nullptr;
    vk::raii::PipelineLayout layout = nullptr;
    vk::raii::RenderPass renderPass = nullptr;  // raster pipelines
    vk::raii::Pipeline pipeline = nullptr;
};

/// An image that draws go to, with its memory.
struct AttachmentState {
    AttachmentState(Device::Context& owner, vk::Format format, vk::Extent2D size, vk::ImageUsageFlags usage,
                    vk::ImageAspectFlags aspect, const std::string& name);

    vk::raii::DeviceMemory memory = nullptr;
    vk::raii::Image image;
    vk::raii::ImageView view = nullptr;
};

/// Messages of the validation layers; the driver may call from any thread.
class ValidationLog {
public:
    void add(std::string message);
    std::vector<std::string> all() const;
    /// Throws Error(internal) with the messages that were not thrown yet, if there are any.
    void throwIfAny();
    std::vector<std::string> takeUnthrown();

private:
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
    size_t thrown_ = 0;
};

/// A change of a buffer's content that waits for the next submission.
struct Transfer {
    std::shared_ptr<const BufferState> to;
    vk::DeviceSize offset = 0, bytes = 0;
    std::shared_ptr<const BufferState> staging = nullptr;  // copied from here, or
    vk::DeviceSize stagingOffset = 0;
    std::vector<std::byte> inlined = {};  // small data in the command buffer itself; neither: zeros
};

/// Transfers in order, and the staging memory they read.
class TransferQueue {
public:
    explicit TransferQueue(Device::Context& context) : context_(context) {}
    void zero(std::shared_ptr<const BufferState> to, vk::DeviceSize bytes);
    void upload(const std::shared_ptr<const BufferState>& to, vk::DeviceSize offset,
                std::span<const std::byte> data);
    void update(std::shared_ptr<const BufferState> to, std::span<const std::byte> data);
    /// Records and forgets all that waits; what must outlive the command buffer goes to `keep`.
    void record(vk::raii::CommandBuffer& commands, std::vector<std::shared_ptr<const void>>& keep);

private:
    void flush();

    Device::Context& context_;
    std::vector<Transfer> waiting_;
    std::shared_ptr<BufferState> staging_;
    vk::DeviceSize stagingUsed_ = 0;
};

struct Device::Context {
    Context(uint32_t index, DeviceOptions options);
    ~Context();

    ValidationLog log;                       // first: outlives the instance that writes to it
    vk::raii::Instance validated = nullptr;  // under validation, else plainInstance() is used
    vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
    vk::raii::PhysicalDevice physical = nullptr;
    DeviceInfo info;
    DeviceLimits limits;
    vk::PhysicalDeviceLimits vkLimits;
    vk::DeviceSize maxAllocation = 0;
    uint32_t timestampBits = 0;
    uint32_t queueFamily = 0;
    vk::PhysicalDeviceMemoryProperties memory;
    vk::raii::Device device = nullptr;
    vk::raii::Queue queue = nullptr;
    vk::raii::CommandPool commandPool = nullptr;
    vk::raii::PipelineCache pipelineCache = nullptr;
    std::filesystem::path pipelineCacheFile;  // empty: not kept
    TransferQueue transfers{*this};

    /// The first memory type for `needs` on the device. Throws Error(unprocessable) that names `name`.
    uint32_t deviceMemoryType(const vk::MemoryRequirements& needs, const std::string& name) const;
    /// Begins a command buffer that sees every write submitted before it.
    vk::raii::CommandBuffer begin();
    void savePipelineCache() const;
};

/// Everything before is finished and visible to everything after.
void fullBarrier(const vk::raii::CommandBuffer& commands);

/// Turns the Vulkan exception in flight into an Error; `doing` completes "… while <doing>".
[[noreturn]] void rethrow(const std::string& doing);

/// Runs `work`; Vulkan's exceptions and new validation messages come out as Error.
template <typename Work>
auto guarded(Device::Context& context, const std::string& doing, Work&& work) {
    try {
        context.log.throwIfAny();
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            context.log.throwIfAny();
        } else {
            auto result = work();
            context.log.throwIfAny();
            return result;
        }
    } catch (const vk::Error&) {
        rethrow(doing);
    }
}

}  // namespace tilefarm::gpu
