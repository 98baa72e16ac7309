#pragma once
// The interface that worker/agent and main need of worker/vk; no Vulkan header here. Beside it, likewise free
// of Vulkan: buffer.h (texel, storage and uniform buffers), pipeline.h (compute pipelines), commands.h
// (dispatch, wait, read back). What the dispatches of a device share is in context.h, for worker/vk only.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace tilefarm::gpu {

/// Whether lavapipe of this driver name and version bounds loops, "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)" for
/// one. False of other drivers.
bool boundsLoops(const std::string& driver);

/// One Vulkan device as `tilefarm-worker devices` lists it.
struct DeviceInfo {
    uint32_t index = 0;  // in the list that listDevices gives
    std::string name;
    std::string driver;      // driver name and version
    std::string apiVersion;  // "1.3.278"
    bool cpu = false;        // a software device (lavapipe)
    /// The driver ends every loop of an invocation once all of them together made 65,535 rounds, whatever
    /// they had left to do: lavapipe before Mesa 25 (seen with 22.3.6, not with 25.0.7).
    bool boundedLoops = false;
    bool usable = false;  // has what the path tracer needs
    std::string unusableWhy;
};

struct DeviceOptions {
    /// Validation layers; any message of theirs makes the next call throw. Also turned on by the
    /// environment variable TILEFARM_VALIDATION=1, and by =gpu with checks of what kernels access.
    /// Error(unprocessable) if they are not installed.
    bool validation = false;
    /// A queue that draws too (raster.h), where the device has one. Without it a queue that computes only
    /// is preferred: on GPUs it is not shared with the desktop.
    bool graphics = false;
};

/// What a device allows and how it wants its kernels; for sizing buffers and choosing kernel variants.
struct DeviceLimits {
    uint64_t texelElements = 0;  // of one texel buffer
    uint64_t storageBytes = 0;   // of one storage buffer binding
    uint64_t uniformBytes = 0;   // of one uniform buffer binding
    uint32_t groups[3] = {0, 0, 0};
    uint32_t texelBuffers = 0;    // in one pipeline
    uint32_t storageBuffers = 0;  // in one pipeline
    bool graphics = false;        // the queue draws
    uint32_t attachmentSize = 0;  // pixels along a side of what it draws to
    bool timestamps = false;      // else device seconds are host seconds
};

/// All Vulkan devices, GPUs first, then software devices. Empty where there is no Vulkan loader or driver.
std::vector<DeviceInfo> listDevices();

/// A logical device with one compute queue. Everything made from a Device must go before it. Not thread
/// safe: one thread at a time may use a Device and what was made from it.
class Device {
public:
    /// Throws Error(notFound) that lists the devices if `index` is not among them, Error(unprocessable) if
    /// unusable.
    explicit Device(uint32_t index, DeviceOptions options = {});
    ~Device();
    const DeviceInfo& info() const;
    const DeviceLimits& limits() const;

    /// Every message of the validation layers so far, thrown or not.
    std::vector<std::string> validationMessages() const;

    struct Context;
    Context& context() const { return *context_; }

private:
    std::unique_ptr<Context> context_;
};

/// GPUs first, then software devices; the index of the one to use by default. Throws Error(notFound) if
/// no device is usable.
uint32_t defaultDevice();

/// Keeps compiled kernels in `folder` (made if absent) from run to run: specialised modules, Mesa's shader
/// cache for lavapipe, a VkPipelineCache file for other drivers. Call before the first listDevices or Device,
/// and before any other thread starts (it sets an environment variable, unless the user has set that one).
void useShaderCache(const std::filesystem::path& folder);

/// The folder of useShaderCache, else of TILEFARM_SHADER_CACHE; empty if none was named.
const std::filesystem::path& shaderCacheFolder();

/// TILEFARM_SHADER_CACHE of the environment: the folder that processes with caches of their own share, as
/// tests do; empty if it is not set.
std::filesystem::path shaderCacheByEnvironment();

}  // namespace tilefarm::gpu
