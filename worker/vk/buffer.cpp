#include "worker/vk/buffer.h"

#include <fmt/core.h>

#include <cstring>

#include "worker/vk/commands.h"
#include "worker/vk/context.h"

namespace tilefarm::gpu {
namespace {

using Usage = vk::BufferUsageFlagBits;
using Property = vk::MemoryPropertyFlagBits;

constexpr vk::DeviceSize kStagingBytes = 64 << 20;
constexpr vk::DeviceSize kInlineBytes = 65536;  // vkCmdUpdateBuffer's limit

// The first memory type that has all of `wanted`; kNoType if none has.
constexpr uint32_t kNoType = ~0u;
uint32_t memoryType(const vk::PhysicalDeviceMemoryProperties& memory, uint32_t allowed,
                    vk::MemoryPropertyFlags wanted) {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
        if ((allowed >> i & 1) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    return kNoType;
}

// Mapped device memory reads back very slowly on GPUs: results go through cached host memory.
uint32_t chooseMemory(const vk::PhysicalDeviceMemoryProperties& memory, uint32_t allowed, MemoryUse use) {
    const auto first = [&](std::initializer_list<vk::MemoryPropertyFlags> choices) {
        for (auto wanted : choices)
            if (uint32_t type = memoryType(memory, allowed, wanted); type != kNoType) return type;
        return kNoType;
    };
    const auto visible = Property::eHostVisible | Property::eHostCoherent;
    switch (use) {
        case MemoryUse::device: return first({Property::eDeviceLocal, {}});
        case MemoryUse::upload: return first({visible});
        case MemoryUse::readback:
            return first(
                {visible | Property::eHostCached, Property::eHostVisible | Property::eHostCached, visible});
    }
    return kNoType;
}

vk::Format vkFormat(TexelFormat format) {
    switch (format) {
        case TexelFormat::rgba32f: return vk::Format::eR32G32B32A32Sfloat;
        case TexelFormat::rgba32ui: return vk::Format::eR32G32B32A32Uint;
        case TexelFormat::rgba16f: return vk::Format::eR16G16B16A16Sfloat;
        case TexelFormat::rgba8unorm: return vk::Format::eR8G8B8A8Unorm;
    }
    throw Error(ErrorCode::invalidArgument, "Unknown texel format");
}

std::string mebibytes(uint64_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

[[noreturn]] void tooLarge(const std::string& name, const std::string& size, const std::string& limit) {
    throw Error(ErrorCode::unprocessable,
                fmt::format("The scene does not fit the device: buffer '{}' needs {}, the device allows {}",
                            name, size, limit));
}

void checkRange(const std::string& name, uint64_t offset, uint64_t count, uint64_t bytes) {
    if (offset > bytes || count > bytes - offset)
        throw Error(
            ErrorCode::invalidArgument,
            fmt::format("Buffer '{}' has {} bytes; {} at offset {} are outside", name, bytes, count, offset));
}

std::shared_ptr<BufferState> makeBuffer(const Device& device, uint64_t bytes, vk::BufferUsageFlags usage,
                                        const std::string& name) {
    Device::Context& context = device.context();
    return guarded(context, fmt::format("allocating buffer '{}' of {}", name, mebibytes(bytes)), [&] {
        return std::make_shared<BufferState>(context, bytes, usage | Usage::eTransferDst, MemoryUse::device,
                                             name);
    });
}

}  // namespace

size_t texelBytes(TexelFormat format) {
    switch (format) {
        case TexelFormat::rgba32f:
        case TexelFormat::rgba32ui: return 16;
        case TexelFormat::rgba16f: return 8;
        case TexelFormat::rgba8unorm: return 4;
    }
    throw Error(ErrorCode::invalidArgument, "Unknown texel format");
}

uint32_t Device::Context::deviceMemoryType(const vk::MemoryRequirements& needs,
                                           const std::string& name) const {
    const uint32_t type = chooseMemory(memory, needs.memoryTypeBits, MemoryUse::device);
    if (type == kNoType) throw Error(ErrorCode::unprocessable, fmt::format("No memory type for '{}'", name));
    if (needs.size > maxAllocation) tooLarge(name, mebibytes(needs.size), mebibytes(maxAllocation));
    return type;
}

BufferState::BufferState(Device::Context& owner, vk::DeviceSize size, vk::BufferUsageFlags usage,
                         MemoryUse use, const std::string& bufferName)
    : context(owner),
      name(bufferName),
      bytes(size),
      buffer(owner.device, vk::BufferCreateInfo({}, size, usage)) {
    const auto needs = buffer.getMemoryRequirements();
    const uint32_t type = chooseMemory(owner.memory, needs.memoryTypeBits, use);
    if (type == kNoType)
        throw Error(ErrorCode::unprocessable, fmt::format("No memory type for buffer '{}'", name));
    if (needs.size > owner.maxAllocation)
        tooLarge(name, mebibytes(needs.size), mebibytes(owner.maxAllocation));
    memory = vk::raii::DeviceMemory(owner.device, vk::MemoryAllocateInfo(needs.size, type));
    buffer.bindMemory(*memory, 0);
    coherent = bool(owner.memory.memoryTypes[type].propertyFlags & Property::eHostCoherent);
    if (use != MemoryUse::device) mapped = static_cast<std::byte*>(memory.mapMemory(0, VK_WHOLE_SIZE));
}

TexelBuffer::TexelBuffer(const Device& device, TexelFormat format, std::span<const std::byte> data,
                         const std::string& name) {
    static constexpr std::byte kZeroTexel[16] = {};
    const size_t size = texelBytes(format);
    if (data.size() % size != 0)
        throw Error(ErrorCode::invalidArgument, fmt::format("Buffer '{}' does not hold whole texels", name));
    if (data.empty()) data = std::span(kZeroTexel, size);
    texels_ = data.size() / size;
    if (texels_ > device.limits().texelElements)
        tooLarge(name, fmt::format("{} texels", texels_), fmt::format("{}", device.limits().texelElements));
    auto buffer = makeBuffer(device, data.size(), Usage::eUniformTexelBuffer, name);
    Device::Context& context = device.context();
    guarded(context, fmt::format("uploading buffer '{}'", name), [&] {
        buffer->view = vk::raii::BufferView(
            context.device,
            vk::BufferViewCreateInfo({}, *buffer->buffer, vkFormat(format), 0, VK_WHOLE_SIZE));
        context.transfers.upload(buffer, 0, data);
    });
    state_ = std::move(buffer);
}

StorageBuffer::StorageBuffer(const Device& device, uint64_t bytes, const std::string& name)
    : bytes_((bytes + 3) / 4 * 4) {  // fills and copies work on whole words
    if (bytes_ == 0) bytes_ = 4;
    if (bytes_ > device.limits().storageBytes)
        tooLarge(name, mebibytes(bytes_), mebibytes(device.limits().storageBytes));
    state_ = makeBuffer(device, bytes_, Usage::eStorageBuffer | Usage::eTransferSrc, name);
    zero();
}

void StorageBuffer::zero() {
    state_->context.transfers.zero(state_, bytes_);
}

void StorageBuffer::upload(std::span<const std::byte> data, uint64_t offset) {
    checkRange(state_->name, offset, data.size(), bytes_);
    guarded(state_->context, fmt::format("uploading buffer '{}'", state_->name),
            [&] { state_->context.transfers.upload(state_, offset, data); });
}

void StorageBuffer::read(std::span<std::byte> to, uint64_t offset) const {
    checkRange(state_->name, offset, to.size(), bytes_);
    if (to.empty()) return;
    CommandRun run(state_->context);
    const size_t index = run.read(*this, offset, to.size());
    Submission submission = run.submit();
    std::memcpy(to.data(), submission.bytes(index).data(), to.size());
}

UniformBuffer::UniformBuffer(const Device& device, uint64_t bytes, const std::string& name)
    : bytes_((bytes + 15) / 16 * 16) {
    if (bytes_ == 0 || bytes_ > device.limits().uniformBytes)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("Uniform buffer '{}' must have 1 to {} bytes, not {}", name,
                                device.limits().uniformBytes, bytes));
    state_ = makeBuffer(device, bytes_, Usage::eUniformBuffer, name);
    state_->context.transfers.zero(state_, bytes_);
}

void UniformBuffer::update(std::span<const std::byte> data) {
    checkRange(state_->name, 0, data.size(), bytes_);
    state_->context.transfers.update(state_, data);
}

void TransferQueue::zero(std::shared_ptr<const BufferState> to, vk::DeviceSize bytes) {
    Transfer transfer;
    transfer.to = std::move(to);
    transfer.bytes = bytes;
    waiting_.push_back(std::move(transfer));
}

void TransferQueue::update(std::shared_ptr<const BufferState> to, std::span<const std::byte> data) {
    Transfer transfer;
    transfer.to = std::move(to);
    transfer.inlined.assign(data.begin(), data.end());
    transfer.inlined.resize((data.size() + 3) / 4 * 4);
    transfer.bytes = transfer.inlined.size();
    if (transfer.bytes > kInlineBytes) throw Error(ErrorCode::internal, "An update holds at most 64 KiB");
    if (transfer.bytes) waiting_.push_back(std::move(transfer));
}

void TransferQueue::upload(const std::shared_ptr<const BufferState>& to, vk::DeviceSize offset,
                           std::span<const std::byte> data) {
    while (!data.empty()) {
        if (staging_ && stagingUsed_ == staging_->bytes) flush();
        if (!staging_) {
            staging_ = std::make_shared<BufferState>(context_, kStagingBytes, Usage::eTransferSrc,
                                                     MemoryUse::upload, "staging");
            stagingUsed_ = 0;
        }
        const vk::DeviceSize count = std::min<vk::DeviceSize>(data.size(), staging_->bytes - stagingUsed_);
        std::memcpy(staging_->mapped + stagingUsed_, data.data(), count);
        Transfer transfer;
        transfer.to = to;
        transfer.offset = offset;
        transfer.bytes = count;
        transfer.staging = staging_;
        transfer.stagingOffset = stagingUsed_;
        waiting_.push_back(std::move(transfer));
        stagingUsed_ += count;
        offset += count;
        data = data.subspan(count);
    }
}

void TransferQueue::record(vk::raii::CommandBuffer& commands,
                           std::vector<std::shared_ptr<const void>>& keep) {
    for (Transfer& transfer : waiting_) {
        const vk::Buffer to = *transfer.to->buffer;
        if (transfer.staging)
            commands.copyBuffer(*transfer.staging->buffer, to,
                                vk::BufferCopy(transfer.stagingOffset, transfer.offset, transfer.bytes));
        else if (!transfer.inlined.empty())
            commands.updateBuffer<std::byte>(to, transfer.offset, transfer.inlined);
        else
            commands.fillBuffer(to, transfer.offset, transfer.bytes, 0);
        fullBarrier(commands);  // the next may write the same buffer
        keep.push_back(transfer.to);
    }
    if (staging_) keep.push_back(staging_);
    waiting_.clear();
    staging_.reset();
}

void TransferQueue::flush() {
    CommandRun(context_).runAndWait();
}

}  // namespace tilefarm::gpu
