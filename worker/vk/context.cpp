#include "worker/vk/context.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "worker/cache_file/cache_file.h"
#include "worker/vk/enumerate.h"

namespace tilefarm::gpu {
namespace {

bool draws(const vk::QueueFamilyProperties& family) {
    return bool(family.queueFlags & vk::QueueFlagBits::eGraphics);
}

uint32_t computeFamily(const std::vector<vk::QueueFamilyProperties>& families, bool graphics) {
    for (const bool wanted : {graphics, !graphics})
        for (uint32_t i = 0; i < families.size(); ++i)
            if (families[i].queueFlags & vk::QueueFlagBits::eCompute && wanted == draws(families[i]))
                return i;
    throw Error(ErrorCode::unprocessable, "The Vulkan device has no compute queue");
}

vk::raii::Device makeDevice(const vk::raii::PhysicalDevice& physical, uint32_t family) {
    const float priority = 1.0f;
    vk::DeviceQueueCreateInfo queue({}, family, 1, &priority);
    return vk::raii::Device(physical, vk::DeviceCreateInfo({}, queue));
}

std::string cacheFileName(const vk::PhysicalDeviceProperties& properties) {
    std::string uuid;
    for (uint8_t byte : properties.pipelineCacheUUID) uuid += fmt::format("{:02x}", byte);
    return fmt::format("pipelines-{:04x}-{:04x}-{}.bin", properties.vendorID, properties.deviceID, uuid);
}

}  // namespace

void ValidationLog::add(std::string message) {
    std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::all() const {
    std::lock_guard lock(mutex_);
    return messages_;
}

std::vector<std::string> ValidationLog::takeUnthrown() {
    std::lock_guard lock(mutex_);
    std::vector<std::string> fresh(messages_.begin() + static_cast<std::ptrdiff_t>(thrown_), messages_.end());
    thrown_ = messages_.size();
    return fresh;
}

void ValidationLog::throwIfAny() {
    const auto fresh = takeUnthrown();
    if (!fresh.empty())
        throw Error(ErrorCode::internal, fmt::format("Vulkan validation: {}", fmt::join(fresh, "\n")));
}

void rethrow(const std::string& doing) {
    try {
        throw;
    } catch (const vk::DeviceLostError&) {
        throw Error(
            ErrorCode::internal,
            fmt::format(
                "The Vulkan device was lost while {}: the driver reset it after a fault or a dispatch "
                "that took too long",
                doing));
    } catch (const vk::OutOfDeviceMemoryError&) {
        throw Error(ErrorCode::unprocessable,
                    fmt::format("The Vulkan device is out of memory while {}", doing));
    } catch (const vk::OutOfHostMemoryError&) {
        throw Error(ErrorCode::unprocessable,
                    fmt::format("The Vulkan driver is out of memory while {}", doing));
    } catch (const vk::Error& error) {
        throw Error(ErrorCode::internal, fmt::format("Vulkan failed while {}: {}", doing, error.what()));
    }
}

Device::Context::Context(uint32_t index, DeviceOptions options) {
    const vk::raii::Instance* instance = &plainInstance();
    if (options.validation || validationByEnvironment()) {
        validated = validatedInstance(log);
        messenger = vk::raii::DebugUtilsMessengerEXT(validated, messengerInfo(log));
        instance = &validated;
    }
    Found found = findDevice(*instance, index);
    physical = std::move(found.physical);
    info = found.info;
    limits = found.limits;
    vkLimits = physical.getProperties().limits;
    maxAllocation =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceMaintenance3Properties>()
            .get<vk::PhysicalDeviceMaintenance3Properties>()
            .maxMemoryAllocationSize;
    memory = physical.getMemoryProperties();
    const auto families = physical.getQueueFamilyProperties();
    queueFamily = computeFamily(families, options.graphics);
    limits.graphics = draws(families[queueFamily]);
    timestampBits = families[queueFamily].timestampValidBits;
    limits.timestamps = timestampBits != 0 && vkLimits.timestampPeriod > 0;
    device = makeDevice(physical, queueFamily);
    queue = device.getQueue(queueFamily, 0);
    commandPool = vk::raii::CommandPool(
        device, vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eTransient, queueFamily));
    std::vector<std::byte> cached;
    if (!shaderCacheFolder().empty()) {
        pipelineCacheFile = shaderCacheFolder() / cacheFileName(physical.getProperties());
        // Drivers check the header, not what follows it: a torn file must not reach them.
        cached = readCacheFile(pipelineCacheFile);
    }
    pipelineCache =
        vk::raii::PipelineCache(device, vk::PipelineCacheCreateInfo({}, cached.size(), cached.data()));
}

Device::Context::~Context() {
    // A message that came too late for a call to throw must not vanish.
    try {
        if (*device) device.waitIdle();
        for (const std::string& message : log.takeUnthrown())
            std::fprintf(stderr, "Vulkan validation: %s\n", message.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "Vulkan: %s while closing the device\n", error.what());
    }
}

vk::raii::CommandBuffer Device::Context::begin() {
    auto commands =
        std::move(device.allocateCommandBuffers({*commandPool, vk::CommandBufferLevel::ePrimary, 1}).front());
    commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
    fullBarrier(commands);
    return commands;
}

void Device::Context::savePipelineCache() const {
    if (pipelineCacheFile.empty()) return;
    const std::vector<uint8_t> data = pipelineCache.getData();
    writeCacheFile(pipelineCacheFile, std::as_bytes(std::span(data)));
}

void fullBarrier(const vk::raii::CommandBuffer& commands) {
    using Access = vk::AccessFlagBits;
    const vk::MemoryBarrier barrier(Access::eMemoryWrite, Access::eMemoryRead | Access::eMemoryWrite);
    constexpr auto stages = vk::PipelineStageFlagBits::eAllCommands;
    commands.pipelineBarrier(stages, stages, {}, barrier, {}, {});
}

}  // namespace tilefarm::gpu
