#include "worker/vk/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

#include "worker/vk/context.h"
#include "worker/vk/raster_state.h"

namespace tilefarm::gpu {
namespace {

using HostClock = std::chrono::steady_clock;

const std::shared_ptr<const BufferState>& stateOf(const Binding& binding) {
    return std::visit(
        [](const auto& buffer) -> const std::shared_ptr<const BufferState>& { return buffer.state(); },
        binding);
}

BindingKind kindOf(const Binding& binding) {
    return static_cast<BindingKind>(binding.index());
}
static_assert(std::is_same_v<std::variant_alternative_t<size_t(BindingKind::texels), Binding>, TexelBuffer>);
static_assert(
    std::is_same_v<std::variant_alternative_t<size_t(BindingKind::storage), Binding>, StorageBuffer>);
static_assert(
    std::is_same_v<std::variant_alternative_t<size_t(BindingKind::uniform), Binding>, UniformBuffer>);

}  // namespace

struct CommandRun::Step {
    // A dispatch,
    std::shared_ptr<const PipelineState> pipeline;
    std::vector<Binding> bindings;
    std::vector<std::byte> pushConstants;
    uint32_t groups[3] = {0, 0, 0};
    // or a draw to a target, which is copied to a buffer,
    std::shared_ptr<const TargetState> target;
    std::shared_ptr<const BufferState> to;
    uint32_t vertices = 0, background = 0;
    // or a copy to the host.
    std::shared_ptr<const BufferState> from;
    vk::DeviceSize offset = 0, bytes = 0;
};

struct Submission::State {
    explicit State(Device::Context& owner) : context(owner) {}
    ~State();

    void bind(const CommandRun::Step& step, vk::PipelineBindPoint point);
    void recordDispatch(const CommandRun::Step& step);
    void recordDraw(const CommandRun::Step& step);
    void record(const CommandRun::Step& step);
    void recordRead(const CommandRun::Step& step);
    void makePools(const std::vector<CommandRun::Step>& steps);
    void submit();
    void finish();
    double deviceSeconds() const;

    Device::Context& context;
    std::vector<std::shared_ptr<const void>> keep;
    std::vector<BufferState> readbacks;
    vk::raii::DescriptorPool descriptors = nullptr;
    std::vector<vk::raii::DescriptorSet> sets;
    vk::raii::QueryPool timestamps = nullptr;
    vk::raii::CommandBuffer commands = nullptr;
    vk::raii::Fence fence = nullptr;
    HostClock::time_point submitted;
    bool timed = false, finished = true;
    double seconds = 0;
};

// Work in flight reads this object's buffers, so it must end first.
Submission::State::~State() {
    try {
        if (!finished) finish();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "Vulkan: %s\n", error.what());
    }
    sets.clear();  // before their pool
}

void Submission::State::makePools(const std::vector<CommandRun::Step>& steps) {
    const auto dispatches = std::count_if(steps.begin(), steps.end(),
                                          [](const CommandRun::Step& step) { return bool(step.pipeline); });
    if (dispatches == 0) return;
    uint32_t counts[3] = {0, 0, 0};
    for (const auto& step : steps)
        for (const Binding& binding : step.bindings) ++counts[size_t(kindOf(binding))];
    std::vector<vk::DescriptorPoolSize> sizes;
    const vk::DescriptorType types[3] = {vk::DescriptorType::eUniformTexelBuffer,
                                         vk::DescriptorType::eStorageBuffer,
                                         vk::DescriptorType::eUniformBuffer};
    for (size_t kind = 0; kind < 3; ++kind)
        if (counts[kind]) sizes.emplace_back(types[kind], counts[kind]);
    descriptors = vk::raii::DescriptorPool(
        context.device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                     static_cast<uint32_t>(dispatches), sizes));
    timed = true;
    if (!context.limits.timestamps) return;
    timestamps =
        vk::raii::QueryPool(context.device, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2));
    commands.resetQueryPool(*timestamps, 0, 2);
    commands.writeTimestamp(vk::PipelineStageFlagBits::eTopOfPipe, *timestamps, 0);
}

// The step's pipeline with its buffers and push constants.
void Submission::State::bind(const CommandRun::Step& step, vk::PipelineBindPoint point) {
    const PipelineState& pipeline = *step.pipeline;
    auto set = std::move(vk::raii::DescriptorSets(
                             context.device, vk::DescriptorSetAllocateInfo(*descriptors, *pipeline.setLayout))
                             .front());
    for (uint32_t i = 0; i < step.bindings.size(); ++i) {
        const BufferState& buffer = *stateOf(step.bindings[i]);
        const vk::DescriptorBufferInfo whole(*buffer.buffer, 0, VK_WHOLE_SIZE);
        vk::WriteDescriptorSet write(*set, i, 0, 1);
        switch (kindOf(step.bindings[i])) {
            case BindingKind::texels:
                write.setDescriptorType(vk::DescriptorType::eUniformTexelBuffer)
                    .setPTexelBufferView(&*buffer.view);
                break;
            case BindingKind::storage:
                write.setDescriptorType(vk::DescriptorType::eStorageBuffer).setPBufferInfo(&whole);
                break;
            case BindingKind::uniform:
                write.setDescriptorType(vk::DescriptorType::eUniformBuffer).setPBufferInfo(&whole);
                break;
        }
        context.device.updateDescriptorSets(write, {});
        keep.push_back(stateOf(step.bindings[i]));
    }
    commands.bindPipeline(point, *pipeline.pipeline);
    commands.bindDescriptorSets(point, *pipeline.layout, 0, *set, {});
    if (!step.pushConstants.empty())
        commands.pushConstants<std::byte>(*pipeline.layout, pipeline.stages, 0, step.pushConstants);
    keep.push_back(step.pipeline);
    sets.push_back(std::move(set));
}

void Submission::State::recordDispatch(const CommandRun::Step& step) {
    bind(step, vk::PipelineBindPoint::eCompute);
    commands.dispatch(step.groups[0], step.groups[1], step.groups[2]);
    fullBarrier(commands);
}

void Submission::State::recordDraw(const CommandRun::Step& step) {
    const TargetState& target = *step.target;
    const vk::Extent2D size = target.size;
    const uint32_t b = step.background;
    const std::array<vk::ClearValue, 2> clear{
        vk::ClearValue(vk::ClearColorValue(std::array<uint32_t, 4>{b, b, b, b})),
        vk::ClearValue(vk::ClearDepthStencilValue(0.f, 0))};
    commands.setViewport(
        0, vk::Viewport(0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1));
    commands.setScissor(0, vk::Rect2D({0, 0}, size));
    bind(step, vk::PipelineBindPoint::eGraphics);
    commands.beginRenderPass(
        vk::RenderPassBeginInfo(*target.renderPass, *target.framebuffer, {{0, 0}, size}, clear),
        vk::SubpassContents::eInline);
    if (step.vertices > 0) commands.draw(step.vertices, 1, 0, 0);
    commands.endRenderPass();
    const vk::BufferImageCopy whole(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {0, 0, 0},
                                    {size.width, size.height, 1});
    commands.copyImageToBuffer(*target.colour.image, vk::ImageLayout::eTransferSrcOptimal, *step.to->buffer,
                               whole);
    fullBarrier(commands);
    keep.push_back(step.target);
    keep.push_back(step.to);
}

void Submission::State::record(const CommandRun::Step& step) {
    if (step.target)
        recordDraw(step);
    else if (step.pipeline)
        recordDispatch(step);
    else
        recordRead(step);
}

void Submission::State::recordRead(const CommandRun::Step& step) {
    const BufferState& to = readbacks.emplace_back(context, step.bytes, vk::BufferUsageFlagBits::eTransferDst,
                                                   MemoryUse::readback, step.from->name + " (readback)");
    commands.copyBuffer(*step.from->buffer, *to.buffer, vk::BufferCopy(step.offset, 0, step.bytes));
    fullBarrier(commands);
    keep.push_back(step.from);
}

void Submission::State::submit() {
    if (*timestamps) commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *timestamps, 1);
    const vk::MemoryBarrier toHost(vk::AccessFlagBits::eMemoryWrite, vk::AccessFlagBits::eHostRead);
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eHost, {},
                             toHost, {}, {});
    commands.end();
    fence = vk::raii::Fence(context.device, vk::FenceCreateInfo());
    submitted = HostClock::now();
    context.queue.submit(vk::SubmitInfo({}, {}, *commands), *fence);
    finished = false;
}

void Submission::State::finish() {
    finished = true;  // also if waiting fails: there is nothing to wait for on a lost device
    const auto result = context.device.waitForFences(*fence, VK_TRUE, std::numeric_limits<uint64_t>::max());
    if (result != vk::Result::eSuccess) throw Error(ErrorCode::internal, "The Vulkan device did not finish");
    if (timed)
        seconds = *timestamps ? deviceSeconds()
                              : std::chrono::duration<double>(HostClock::now() - submitted).count();
    for (const BufferState& readback : readbacks)
        if (!readback.coherent)
            context.device.invalidateMappedMemoryRanges(
                vk::MappedMemoryRange(*readback.memory, 0, VK_WHOLE_SIZE));
}

double Submission::State::deviceSeconds() const {
    const auto [result, ticks] =
        timestamps.getResults<uint64_t>(0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t),
                                        vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess)
        throw Error(ErrorCode::internal, "The Vulkan device gave no timestamps");
    const uint64_t mask = context.timestampBits == 64 ? ~0ull : (1ull << context.timestampBits) - 1;
    return static_cast<double>((ticks[1] - ticks[0]) & mask) * context.vkLimits.timestampPeriod * 1e-9;
}

Submission::Submission(std::unique_ptr<State> state) : state_(std::move(state)) {}
Submission::Submission(Submission&&) noexcept = default;
Submission& Submission::operator=(Submission&&) noexcept = default;
Submission::~Submission() = default;

bool Submission::done() const {
    return guarded(state_->context, "asking whether a submission is done",
                   [&] { return state_->finished || state_->fence.getStatus() == vk::Result::eSuccess; });
}

double Submission::wait() {
    return guarded(state_->context, "waiting for a submission", [&] {
        if (!state_->finished) state_->finish();
        return state_->seconds;
    });
}

std::span<const std::byte> Submission::bytes(size_t index) {
    wait();
    const BufferState& readback = state_->readbacks.at(index);
    return {readback.mapped, static_cast<size_t>(readback.bytes)};
}

CommandRun::CommandRun(const Device& device) : CommandRun(device.context()) {}
CommandRun::CommandRun(Device::Context& context) : context_(&context) {}
CommandRun::~CommandRun() = default;
CommandRun::CommandRun(CommandRun&&) noexcept = default;

CommandRun::Step& CommandRun::addStep(const std::shared_ptr<const PipelineState>& pipeline,
                                      const std::vector<Binding>& bindings,
                                      std::span<const std::byte> pushConstants) {
    const auto fault = [&](const std::string& message) {
        throw Error(ErrorCode::invalidArgument, fmt::format("Work of '{}': {}", pipeline->name, message));
    };
    const auto& kinds = pipeline->kinds;
    if (bindings.size() != kinds.size())
        fault(fmt::format("{} bindings given, {} wanted", bindings.size(), kinds.size()));
    for (size_t i = 0; i < kinds.size(); ++i)
        if (kindOf(bindings[i]) != kinds[i]) fault(fmt::format("binding {} is of the wrong kind", i));
    if (pushConstants.size() != pipeline->pushConstantBytes)
        fault(fmt::format("{} bytes of push constants given, {} wanted", pushConstants.size(),
                          pipeline->pushConstantBytes));
    Step& step = steps_.emplace_back();
    step.pipeline = pipeline;
    step.bindings = bindings;
    step.pushConstants.assign(pushConstants.begin(), pushConstants.end());
    return step;
}

void CommandRun::dispatch(const ComputePipeline& pipeline, const std::vector<Binding>& bindings,
                          std::span<const std::byte> pushConstants, uint32_t groupsX, uint32_t groupsY,
                          uint32_t groupsZ) {
    const uint32_t groups[3] = {groupsX, groupsY, groupsZ};
    for (int axis = 0; axis < 3; ++axis)
        if (groups[axis] > context_->limits.groups[axis])
            throw Error(
                ErrorCode::invalidArgument,
                fmt::format("Dispatch of '{}': {} groups on axis {}, the device allows {}",
                            pipeline.state()->name, groups[axis], axis, context_->limits.groups[axis]));
    Step& step = addStep(pipeline.state(), bindings, pushConstants);
    std::copy_n(groups, 3, step.groups);
    if (groupsX == 0 || groupsY == 0 || groupsZ == 0) steps_.pop_back();
}

void CommandRun::draw(const RasterPipeline& pipeline, const RasterTarget& target, const StorageBuffer& to,
                      const std::vector<Binding>& bindings, std::span<const std::byte> pushConstants,
                      uint32_t vertices, uint32_t background) {
    if (to.bytes() < target.bytes())
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("Buffer '{}' has {} bytes, the drawn image takes {}", to.state()->name,
                                to.bytes(), target.bytes()));
    Step& step = addStep(pipeline.state(), bindings, pushConstants);
    step.target = target.state();
    step.to = to.state();
    step.vertices = vertices;
    step.background = background;
}

size_t CommandRun::read(const StorageBuffer& from, uint64_t offset, uint64_t bytes) {
    if (bytes == 0) bytes = from.bytes() - std::min(offset, from.bytes());
    if (offset > from.bytes() || bytes == 0 || bytes > from.bytes() - offset)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("Buffer '{}' has {} bytes; {} at offset {} are outside", from.state()->name,
                                from.bytes(), bytes, offset));
    Step step;
    step.from = from.state();
    step.offset = offset;
    step.bytes = bytes;
    steps_.push_back(std::move(step));
    return static_cast<size_t>(
        std::count_if(steps_.begin(), steps_.end(), [](const Step& each) { return bool(each.from); }) - 1);
}

Submission CommandRun::submit() {
    const std::vector<Step> steps = std::exchange(steps_, {});
    return guarded(*context_, "submitting work", [&] {
        auto state = std::make_unique<Submission::State>(*context_);
        state->commands = context_->begin();
        context_->transfers.record(state->commands, state->keep);
        state->makePools(steps);
        state->readbacks.reserve(steps.size());
        for (const Step& step : steps) state->record(step);
        state->submit();
        return Submission(std::move(state));
    });
}

}  // namespace tilefarm::gpu
