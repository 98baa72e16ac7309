#include "worker/vk/device.h"

#include <fmt/core.h>

#include "worker/vk/context.h"
#include "worker/vk/enumerate.h"

namespace tilefarm::gpu {

std::vector<DeviceInfo> listDevices() {
    std::vector<DeviceInfo> devices;
    try {
        for (Found& found : findDevices(plainInstance())) devices.push_back(std::move(found.info));
    } catch (const vk::Error&) {
        // No driver at all (incompatible driver), or none that comes up: there is nothing to list.
    } catch (const std::runtime_error&) {
        // The loader library itself is missing.
    }
    return devices;
}

uint32_t defaultDevice() {
    const auto devices = listDevices();
    for (const DeviceInfo& device : devices)
        if (device.usable) return device.index;
    std::string why;
    for (const DeviceInfo& device : devices) why += fmt::format("; {}: {}", device.name, device.unusableWhy);
    throw Error(ErrorCode::notFound,
                fmt::format("No usable Vulkan device{} (a GPU driver or Mesa's lavapipe is needed)", why));
}

Device::Device(uint32_t index, DeviceOptions options) {
    try {
        context_ = std::make_unique<Context>(index, options);
        context_->log.throwIfAny();
    } catch (const vk::IncompatibleDriverError&) {
        throw Error(ErrorCode::notFound,
                    fmt::format("There is no Vulkan device {}: no Vulkan driver was found", index));
    } catch (const vk::Error&) {
        rethrow("opening the device");
    } catch (const Error&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::notFound,
                    fmt::format("There is no Vulkan device {}: no Vulkan loader ({})", index, error.what()));
    }
}

Device::~Device() = default;

const DeviceInfo& Device::info() const {
    return context_->info;
}
const DeviceLimits& Device::limits() const {
    return context_->limits;
}
std::vector<std::string> Device::validationMessages() const {
    return context_->log.all();
}

}  // namespace tilefarm::gpu
