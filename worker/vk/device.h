#pragma once
// The interface that worker/agent and main need of worker/vk; no Vulkan header here.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tilefarm::gpu {

/// One Vulkan device as `tilefarm-worker devices` lists it.
struct DeviceInfo {
    uint32_t index = 0;
    std::string name;
    std::string driver;       // driver name and version
    std::string apiVersion;   // "1.3.278"
    bool cpu = false;         // a software device (lavapipe)
    bool usable = false;      // has what the path tracer needs
    std::string unusableWhy;
};

struct DeviceOptions {
    bool validation = false;  // validation layers; any message of theirs makes the next call throw
};

std::vector<DeviceInfo> listDevices();

/// A logical device with one compute queue. The body and the Vulkan side are in vk/context.h.
class Device {
public:
    /// Throws Error(notFound) that lists the devices if `index` is not among them, Error(unprocessable) if unusable.
    explicit Device(uint32_t index, DeviceOptions options = {});
    ~Device();
    const DeviceInfo& info() const;

    struct Context;
    Context& context() const { return *context_; }

private:
    std::unique_ptr<Context> context_;
};

/// GPUs first, then software devices; the index of the one to use by default.
uint32_t defaultDevice();

}  // namespace tilefarm::gpu
