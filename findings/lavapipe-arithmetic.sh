#!/usr/bin/env bash
# lavapipe, a CPU driver, computes less exactly than the CPU it runs on: fma, acos, asin, NaN * 0.0.
#
# Expected: a driver that turns shaders into machine code of a CPU gives what the same C++ gives. GLSL 4.60, 8.3: where
#   the result is `precise`, fma() is one operation, rounded once. acos and asin have most digits of a float. NaN times
#   0.0 is NaN.
# Seen: fma(a, b, c) rounds twice, `precise` or not, on processors with FMA too; acos is off by up to 1.6e-4 rad and asin
#   by 3.9e-4 (atan(y, x) has all digits); NaN * 0.0 is 0.0. All of it is within what Vulkan demands,
#   which is why no validation layer tells.
# Matters to: whoever takes lavapipe as the exact reference for a GPU, or writes error-free transforms with fma.
# Versions: Debian 12, mesa-vulkan-drivers 25.0.7-2~bpo12+1 (backports), glslang-tools 12.0.0-2. Seen 2026-11-30.
set -euo pipefail
export LC_ALL=C
fail() { echo "CHANGED: $*" >&2; exit 1; }
mesa=25.0.7-2~bpo12+1
have() { [ "$(dpkg-query -W -f='${Version}' "$1" 2>/dev/null)" = "$2" ]; }
if ! have mesa-vulkan-drivers "$mesa" || ! have libvulkan-dev 1.3.239.0-1 || ! command -v glslangValidator g++ >/dev/null; then
    # Wants the suite bookworm-backports among apt's sources.
    apt-get -qq update
    apt-get -qq install -y --no-install-recommends g++ glslang-tools libvulkan-dev=1.3.239.0-1 "mesa-vulkan-drivers=$mesa" >/dev/null
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat > probe.comp <<'GLSL'
#version 460
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Values { float v[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i > 0u) {  // acos and asin over (-1, 1)
        float x = v[3u * i];
        v[3u * i + 1u] = acos(x);
        v[3u * i + 2u] = asin(x);
        return;
    }
    float a = v[0], c = v[1], nan = v[2];
    precise float once = fma(a, a, c);
    float product = nan * 0.0;
    v[0] = once;
    v[1] = product;
}
GLSL
glslangValidator --quiet -V --target-env vulkan1.1 --vn spirv -o probe.h probe.comp

cat > probe.cpp <<'CPP'
#include <vulkan/vulkan.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "probe.h"

void check(VkResult result) {
    if (result != VK_SUCCESS) std::exit(2);
}

int main() {
    constexpr uint32_t kCount = 65536;
    VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    app.apiVersion = VK_API_VERSION_1_1;
    VkInstanceCreateInfo instanceInfo{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    instanceInfo.pApplicationInfo = &app;
    VkInstance instance;
    check(vkCreateInstance(&instanceInfo, nullptr, &instance));
    uint32_t count = 16;
    VkPhysicalDevice physicals[16];
    check(vkEnumeratePhysicalDevices(instance, &count, physicals));
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    for (uint32_t i = 0; i < count; ++i) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(physicals[i], &properties);
        if (std::strncmp(properties.deviceName, "llvmpipe", 8) != 0) continue;
        physical = physicals[i];
        std::printf("device: %s\n", properties.deviceName);
    }
    if (!physical) return 2;

    const float priority = 1;
    VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queueInfo.queueCount = 1;
    queueInfo.pQueuePriorities = &priority;
    VkDeviceCreateInfo deviceInfo{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    deviceInfo.queueCreateInfoCount = 1;
    deviceInfo.pQueueCreateInfos = &queueInfo;
    VkDevice device;
    check(vkCreateDevice(physical, &deviceInfo, nullptr, &device));
    VkQueue queue;
    vkGetDeviceQueue(device, 0, 0, &queue);

    VkBufferCreateInfo bufferInfo{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    bufferInfo.size = 3 * kCount * sizeof(float);
    bufferInfo.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    VkBuffer buffer;
    check(vkCreateBuffer(device, &bufferInfo, nullptr, &buffer));
    VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};  // all of lavapipe's memory is the host's
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device, buffer, &needs);
    allocation.allocationSize = needs.size;
    VkDeviceMemory memory;
    check(vkAllocateMemory(device, &allocation, nullptr, &memory));
    check(vkBindBufferMemory(device, buffer, memory, 0));
    float* v;
    check(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, reinterpret_cast<void**>(&v)));
    for (uint32_t i = 0; i < kCount; ++i) v[3 * i] = std::fmin(std::fmax((2.f * i + 1) / kCount - 1, -1.f), 1.f);
    // (1 + e)² − (1 + 2e) = e²: gone if the square is rounded first.
    const float e = std::ldexp(1.f, -20);
    v[0] = 1 + e, v[1] = -(1 + 2 * e), v[2] = NAN;
    const float a = v[0], c = v[1];
    std::vector<float> x(kCount);
    for (uint32_t i = 1; i < kCount; ++i) x[i] = v[3 * i];

    VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    VkDescriptorSetLayoutCreateInfo setInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    setInfo.bindingCount = 1;
    setInfo.pBindings = &binding;
    VkDescriptorSetLayout setLayout;
    check(vkCreateDescriptorSetLayout(device, &setInfo, nullptr, &setLayout));
    VkDescriptorPoolSize poolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    poolInfo.maxSets = poolInfo.poolSizeCount = 1;
    poolInfo.pPoolSizes = &poolSize;
    VkDescriptorPool pool;
    check(vkCreateDescriptorPool(device, &poolInfo, nullptr, &pool));
    VkDescriptorSetAllocateInfo setAllocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool, 1, &setLayout};
    VkDescriptorSet set;
    check(vkAllocateDescriptorSets(device, &setAllocation, &set));
    VkDescriptorBufferInfo range{buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &range;
    vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);

    VkShaderModuleCreateInfo moduleInfo{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, sizeof spirv, spirv};
    VkShaderModule module;
    check(vkCreateShaderModule(device, &moduleInfo, nullptr, &module));
    VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layoutInfo.setLayoutCount = 1;
    layoutInfo.pSetLayouts = &setLayout;
    VkPipelineLayout layout;
    check(vkCreatePipelineLayout(device, &layoutInfo, nullptr, &layout));
    VkComputePipelineCreateInfo pipelineInfo{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    pipelineInfo.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_COMPUTE_BIT, module, "main", nullptr};
    pipelineInfo.layout = layout;
    VkPipeline pipeline;
    check(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipelineInfo, nullptr, &pipeline));

    VkCommandPoolCreateInfo commandPoolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool commandPool;
    check(vkCreateCommandPool(device, &commandPoolInfo, nullptr, &commandPool));
    VkCommandBufferAllocateInfo commandInfo{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, commandPool, VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VkCommandBuffer commands;
    check(vkAllocateCommandBuffers(device, &commandInfo, &commands));
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    check(vkBeginCommandBuffer(commands, &begin));
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, nullptr);
    vkCmdDispatch(commands, kCount / 64, 1, 1);
    check(vkEndCommandBuffer(commands));
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE));
    check(vkQueueWaitIdle(queue));

    double acosError = 0, asinError = 0, hostError = 0;
    for (uint32_t i = 1; i < kCount; ++i) {
        acosError = std::fmax(acosError, std::fabs(v[3 * i + 1] - std::acos(double{x[i]})));
        asinError = std::fmax(asinError, std::fabs(v[3 * i + 2] - std::asin(double{x[i]})));
        hostError = std::fmax(hostError, std::fabs(std::acos(x[i]) - std::acos(double{x[i]})));
    }
    std::printf("precise fma: %g, the host's %g\n", v[0], std::fma(a, a, c));
    std::printf("NaN * 0.0: %g\n", v[1]);
    std::printf("largest error: acos %.2g, asin %.2g, the host's acos of a float %.2g\n", acosError, asinError, hostError);
    if (v[0] != 0) return std::puts("fma rounds once"), 1;
    if (!(v[1] == 0)) return std::puts("NaN * 0.0 is no longer 0"), 1;
    if (acosError < 1e-4 || asinError < 1e-4) return std::puts("acos or asin is exact"), 1;
}
CPP
g++ -std=c++17 -O1 -ffp-contract=off -w probe.cpp -o probe -lvulkan
./probe || fail "lavapipe computes otherwise than it did"
