#include "worker/vk/raster.h"

#include <fmt/core.h>

#include <array>

#include "worker/vk/pipeline_parts.h"
#include "worker/vk/raster_state.h"

namespace tilefarm::gpu {

AttachmentState::AttachmentState(Device::Context& owner, vk::Format format, vk::Extent2D size,
                                 vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect,
                                 const std::string& name)
    : image(owner.device,
            vk::ImageCreateInfo({}, vk::ImageType::e2D, format, {size.width, size.height, 1}, 1, 1,
                                vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal, usage)) {
    const auto needs = image.getMemoryRequirements();
    const uint32_t type = owner.deviceMemoryType(needs, name);
    memory = vk::raii::DeviceMemory(owner.device, vk::MemoryAllocateInfo(needs.size, type));
    image.bindMemory(*memory, 0);
    view = vk::raii::ImageView(owner.device, vk::ImageViewCreateInfo({}, *image, vk::ImageViewType::e2D,
                                                                     format, {}, {aspect, 0, 1, 0, 1}));
}

vk::raii::RenderPass makeRasterPass(const Device::Context& context) {
    using Layout = vk::ImageLayout;
    const auto attachment = [](vk::Format format, vk::AttachmentStoreOp store, Layout last) {
        return vk::AttachmentDescription({}, format, vk::SampleCountFlagBits::e1,
                                         vk::AttachmentLoadOp::eClear, store, vk::AttachmentLoadOp::eDontCare,
                                         vk::AttachmentStoreOp::eDontCare, Layout::eUndefined, last);
    };
    const std::array attachments{
        attachment(kRasterColour, vk::AttachmentStoreOp::eStore, Layout::eTransferSrcOptimal),
        attachment(kRasterDepth, vk::AttachmentStoreOp::eDontCare, Layout::eDepthStencilAttachmentOptimal)};
    const vk::AttachmentReference colour(0, Layout::eColorAttachmentOptimal),
        depth(1, Layout::eDepthStencilAttachmentOptimal);
    const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics, {}, colour, {}, &depth);
    // The layout changes at both ends wait for what came before and hold up what comes after.
    constexpr auto all = vk::PipelineStageFlagBits::eAllCommands,
                   drawing = vk::PipelineStageFlagBits::eAllGraphics;
    constexpr auto write = vk::AccessFlagBits::eMemoryWrite;
    constexpr auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
    const std::array dependencies{vk::SubpassDependency(VK_SUBPASS_EXTERNAL, 0, all, drawing, write, any),
                                  vk::SubpassDependency(0, VK_SUBPASS_EXTERNAL, drawing, all, write, any)};
    return {context.device, vk::RenderPassCreateInfo({}, attachments, subpass, dependencies)};
}

namespace {

vk::raii::Framebuffer makeFramebuffer(const Device::Context& context, const TargetState& target) {
    const std::array views{*target.colour.view, *target.depth.view};
    return {context.device, vk::FramebufferCreateInfo({}, *target.renderPass, views, target.size.width,
                                                      target.size.height, 1)};
}

void compile(const Device::Context& context, const PipelineSpec& spec, std::span<const uint32_t> fragment,
             PipelineState& state) {
    using Stage = vk::ShaderStageFlagBits;
    const StageConstants constants(spec.constants);
    const auto vertexModule = shaderModule(context, spec.spirv, spec.constants),
               fragmentModule = shaderModule(context, fragment, spec.constants);
    const std::array stages{
        vk::PipelineShaderStageCreateInfo({}, Stage::eVertex, *vertexModule, "main", &constants.info()),
        vk::PipelineShaderStageCreateInfo({}, Stage::eFragment, *fragmentModule, "main", &constants.info())};
    const vk::PipelineVertexInputStateCreateInfo noInput;
    const vk::PipelineInputAssemblyStateCreateInfo triangles({}, vk::PrimitiveTopology::eTriangleList);
    const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
    vk::PipelineRasterizationStateCreateInfo rasterization;
    rasterization.lineWidth = 1;
    const vk::PipelineMultisampleStateCreateInfo oneSample({}, vk::SampleCountFlagBits::e1);
    const vk::PipelineDepthStencilStateCreateInfo depth({}, true, true, vk::CompareOp::eGreater);
    vk::PipelineColorBlendAttachmentState replace;
    using Component = vk::ColorComponentFlagBits;
    replace.colorWriteMask = Component::eR | Component::eG | Component::eB | Component::eA;
    const vk::PipelineColorBlendStateCreateInfo blend({}, false, vk::LogicOp::eCopy, replace);
    const std::array moving{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
    const vk::PipelineDynamicStateCreateInfo dynamic({}, moving);
    state.renderPass = makeRasterPass(context);
    state.pipeline =
        vk::raii::Pipeline(context.device, context.pipelineCache,
                           vk::GraphicsPipelineCreateInfo(
                               {}, stages, &noInput, &triangles, nullptr, &viewport, &rasterization,
                               &oneSample, &depth, &blend, &dynamic, *state.layout, *state.renderPass));
}

}  // namespace

TargetState::TargetState(const Device& device, vk::Extent2D extent, const std::string& name)
    : size(extent),
      colour(device.context(), kRasterColour, extent,
             vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc,
             vk::ImageAspectFlagBits::eColor, name),
      depth(device.context(), kRasterDepth, extent, vk::ImageUsageFlagBits::eDepthStencilAttachment,
            vk::ImageAspectFlagBits::eDepth, name),
      renderPass(makeRasterPass(device.context())),
      framebuffer(makeFramebuffer(device.context(), *this)) {}

RasterTarget::RasterTarget(const Device& device, uint32_t width, uint32_t height, const std::string& name)
    : width_(width), height_(height) {
    if (!device.limits().graphics)
        throw Error(ErrorCode::unprocessable,
                    "The Vulkan device has no queue that draws, which the raster "
                    "integrator needs");
    const uint32_t most = device.limits().attachmentSize;
    if (width == 0 || height == 0 || width > most || height > most)
        throw Error(ErrorCode::unprocessable,
                    fmt::format("The device draws images of 1 to {} pixels along a side, not {} x {}", most,
                                width, height));
    state_ = guarded(device.context(), fmt::format("making the images '{}'", name), [&] {
        return std::make_shared<TargetState>(device, vk::Extent2D(width, height), name);
    });
}

RasterPipeline::RasterPipeline(const Device& device, const PipelineSpec& spec,
                               std::span<const uint32_t> fragment) {
    Device::Context& context = device.context();
    state_ = guarded(context, fmt::format("compiling shaders '{}'", spec.name), [&] {
        auto state = startPipeline(device, spec,
                                   vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment);
        compile(context, spec, fragment, *state);
        context.savePipelineCache();
        return state;
    });
}

}  // namespace tilefarm::gpu
