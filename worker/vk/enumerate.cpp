#include "worker/vk/enumerate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "worker/vk/context.h"

namespace tilefarm::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr uint32_t kPushConstantBytes = 128, kUniformBytes = 16384;

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    static_cast<ValidationLog*>(user)->add(data->pMessage);
    return VK_FALSE;
}

const vk::ApplicationInfo kApplication("tilefarm", 1, nullptr, 0, VK_API_VERSION_1_2);

const vk::raii::Context& vulkanLoader() {
    static const auto* loader = new vk::raii::Context;
    return *loader;
}

bool hasValidationLayer(const vk::raii::Context& loader) {
    for (const auto& layer : loader.enumerateInstanceLayerProperties())
        if (std::strcmp(layer.layerName, kValidationLayer) == 0) return true;
    return false;
}

int rank(vk::PhysicalDeviceType type) {
    switch (type) {
        case vk::PhysicalDeviceType::eDiscreteGpu: return 0;
        case vk::PhysicalDeviceType::eIntegratedGpu: return 1;
        case vk::PhysicalDeviceType::eVirtualGpu: return 2;
        case vk::PhysicalDeviceType::eCpu: return 4;
        default: return 3;
    }
}

std::string whyUnusable(const vk::raii::PhysicalDevice& physical,
                        const vk::PhysicalDeviceProperties& properties) {
    if (properties.apiVersion < VK_API_VERSION_1_2) return "Vulkan 1.2 is needed";
    const auto families = physical.getQueueFamilyProperties();
    if (std::none_of(families.begin(), families.end(), [](const auto& family) {
            return bool(family.queueFlags & vk::QueueFlagBits::eCompute);
        }))
        return "it has no compute queue";
    // What a dispatch counts is added up by subgroups first (shaders/counters.glsl).
    const auto subgroup =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>()
            .get<vk::PhysicalDeviceSubgroupProperties>();
    if (!(subgroup.supportedStages & vk::ShaderStageFlagBits::eCompute) ||
        !(subgroup.supportedOperations & vk::SubgroupFeatureFlagBits::eArithmetic))
        return "its compute kernels cannot add up over subgroups";
    const auto& limits = properties.limits;
    if (limits.maxPushConstantsSize < kPushConstantBytes || limits.maxUniformBufferRange < kUniformBytes)
        return "its limits are below what Vulkan demands";
    return {};
}

std::string driverName(const vk::raii::PhysicalDevice& physical) {
    const auto driver =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>()
            .get<vk::PhysicalDeviceDriverProperties>();
    return fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
}

// Mesa bounds loops by LP_MAX_TGSI_LOOP_ITERATIONS; which version between 22.3 and 25.0 ceased to was not
// looked up.
constexpr int kFirstMesaWithLongLoops = 25;

DeviceInfo describe(const vk::raii::PhysicalDevice& physical,
                    const vk::PhysicalDeviceProperties& properties) {
    DeviceInfo info;
    info.name = properties.deviceName.data();
    info.apiVersion =
        fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(properties.apiVersion),
                    VK_API_VERSION_MINOR(properties.apiVersion), VK_API_VERSION_PATCH(properties.apiVersion));
    info.cpu = properties.deviceType == vk::PhysicalDeviceType::eCpu;
    info.unusableWhy = whyUnusable(physical, properties);
    info.usable = info.unusableWhy.empty();
    // Driver properties are core in 1.2 only.
    info.driver = properties.apiVersion >= VK_API_VERSION_1_2 ? driverName(physical) : "unknown";
    info.boundedLoops = boundsLoops(info.driver);
    return info;
}

DeviceLimits limitsOf(const vk::PhysicalDeviceLimits& from) {
    DeviceLimits limits;
    limits.texelElements = from.maxTexelBufferElements;
    limits.storageBytes = from.maxStorageBufferRange;
    limits.uniformBytes = kUniformBytes;
    limits.attachmentSize = std::min(from.maxFramebufferWidth, from.maxFramebufferHeight);
    std::copy_n(from.maxComputeWorkGroupCount.data(), 3, limits.groups);
    limits.texelBuffers =
        std::min(from.maxPerStageDescriptorSampledImages, from.maxDescriptorSetSampledImages);
    limits.storageBuffers =
        std::min(from.maxPerStageDescriptorStorageBuffers, from.maxDescriptorSetStorageBuffers);
    return limits;
}

std::filesystem::path& cacheFolder() {
    static std::filesystem::path folder = shaderCacheByEnvironment();
    return folder;
}

std::string listed(const std::vector<Found>& found) {
    if (found.empty()) return "there are none";
    std::string text = "there are:";
    for (const Found& each : found) text += fmt::format(" {} = {};", each.info.index, each.info.name);
    text.pop_back();
    return text;
}

}  // namespace

bool boundsLoops(const std::string& driver) {
    if (driver.find("llvmpipe") == std::string::npos) return false;
    const size_t at = driver.find("Mesa ");
    return at != std::string::npos && std::atoi(driver.c_str() + at + 5) < kFirstMesaWithLongLoops;
}

bool validationByEnvironment() {
    const char* value = std::getenv("TILEFARM_VALIDATION");
    return value && (std::strcmp(value, "1") == 0 || std::strcmp(value, "gpu") == 0);
}

bool gpuAssistedByEnvironment() {
    const char* value = std::getenv("TILEFARM_VALIDATION");
    return value && std::strcmp(value, "gpu") == 0;
}

std::filesystem::path shaderCacheByEnvironment() {
    const char* folder = std::getenv("TILEFARM_SHADER_CACHE");
    return folder ? folder : "";
}

const std::filesystem::path& shaderCacheFolder() {
    return cacheFolder();
}

void useShaderCache(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
        throw Error(ErrorCode::invalidArgument, fmt::format("Cannot make the shader cache folder {}: {}",
                                                            folder.string(), failed.message()));
    cacheFolder() = std::filesystem::absolute(folder);
    ::setenv("MESA_SHADER_CACHE_DIR", cacheFolder().c_str(), 0);
}

vk::DebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog& log) {
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    return {{}, Severity::eWarning | Severity::eError, Type::eValidation, onMessage, &log};
}

const vk::raii::Instance& plainInstance() {
    static const auto* instance =
        new vk::raii::Instance(vulkanLoader(), vk::InstanceCreateInfo({}, &kApplication));
    return *instance;
}

vk::raii::Instance validatedInstance(ValidationLog& log) {
    const vk::raii::Context& loader = vulkanLoader();
    if (!hasValidationLayer(loader))
        throw Error(
            ErrorCode::unprocessable,
            "Vulkan validation was asked for, but VK_LAYER_KHRONOS_validation is not installed (Debian: "
            "vulkan-validationlayers)");
    const std::vector<const char*> layers{kValidationLayer}, extensions{VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    using Enable = vk::ValidationFeatureEnableEXT;
    std::vector<Enable> enabled{Enable::eSynchronizationValidation};
    if (gpuAssistedByEnvironment())
        enabled.insert(enabled.end(), {Enable::eGpuAssisted, Enable::eGpuAssistedReserveBindingSlot});
    vk::StructureChain chain{vk::InstanceCreateInfo({}, &kApplication, layers, extensions),
                             messengerInfo(log), vk::ValidationFeaturesEXT(enabled)};
    return vk::raii::Instance(loader, chain.get<vk::InstanceCreateInfo>());
}

std::vector<Found> findDevices(const vk::raii::Instance& instance) {
    std::vector<std::pair<int, Found>> ranked;
    for (auto& physical : vk::raii::PhysicalDevices(instance)) {
        const auto properties = physical.getProperties();
        DeviceInfo info = describe(physical, properties);
        DeviceLimits limits = limitsOf(properties.limits);
        ranked.emplace_back(rank(properties.deviceType), Found{std::move(physical), std::move(info), limits});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Found> found;
    for (auto& [_, each] : ranked) {
        each.info.index = static_cast<uint32_t>(found.size());
        found.push_back(std::move(each));
    }
    return found;
}

Found findDevice(const vk::raii::Instance& instance, uint32_t index) {
    auto found = findDevices(instance);
    if (index >= found.size())
        throw Error(ErrorCode::notFound,
                    fmt::format("There is no Vulkan device {}; {}", index, listed(found)));
    if (!found[index].info.usable)
        throw Error(ErrorCode::unprocessable,
                    fmt::format("Vulkan device {} ({}) cannot be used: {}", index, found[index].info.name,
                                found[index].info.unusableWhy));
    return std::move(found[index]);
}

}  // namespace tilefarm::gpu
