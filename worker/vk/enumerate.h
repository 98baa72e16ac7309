#pragma once
// Instances and physical devices; for worker/vk's sources only.

#include <filesystem>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "worker/vk/device.h"

namespace tilefarm::gpu {

class ValidationLog;

struct Found {
    vk::raii::PhysicalDevice physical = nullptr;
    DeviceInfo info;
    DeviceLimits limits;
};

/// TILEFARM_VALIDATION=1 (or gpu) is in the environment.
bool validationByEnvironment();

/// TILEFARM_VALIDATION=gpu is in the environment: the layers also rewrite the kernels so that these check
/// their own accesses to buffers. Kernels then compile and run many times slower.
bool gpuAssistedByEnvironment();

/// The instance that lists devices and opens them without validation. Made at the first call that finds a
/// driver and kept to the end of the process, with it the loader and the drivers: NVIDIA's driver finds no
/// device any more after it was loaded and unloaded a dozen times (seen with 580.159). Throws
/// std::runtime_error if there is no loader, vk::IncompatibleDriverError if there is no driver.
const vk::raii::Instance& plainInstance();

/// An instance under the validation layers, which begin to send to `log` at once. Throws Error(unprocessable)
/// if they are not installed.
vk::raii::Instance validatedInstance(ValidationLog& log);

/// Sends warnings and errors of validation to `log`. (Loader and driver chatter is of another type.)
vk::DebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog& log);

/// All devices in the order of listDevices.
std::vector<Found> findDevices(const vk::raii::Instance& instance);

/// Device `index` of the list; throws as the constructor of Device does.
Found findDevice(const vk::raii::Instance& instance, uint32_t index);

}  // namespace tilefarm::gpu
