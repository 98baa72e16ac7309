#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "worker/vk/buffer.h"
#include "worker/vk/pipeline.h"
#include "worker/vk/raster.h"

namespace tilefarm::gpu {

using Binding = std::variant<TexelBuffer, StorageBuffer, UniformBuffer>;

/// Work on its way to or on the device. Going out of scope waits for it.
class Submission {
public:
    struct State;
    explicit Submission(std::unique_ptr<State> state);
    Submission(Submission&&) noexcept;
    Submission& operator=(Submission&&) noexcept;
    ~Submission();

    /// True once the device is through; never blocks. Throws Error(internal) if the device was lost.
    bool done() const;
    /// Blocks until the device is through and gives the device's seconds from the start of the first to the
    /// end of the last dispatch (host seconds from submit where the device has no timestamps). May be called
    /// again.
    double wait();
    /// What the `index`-th CommandRun::read copied out; waits first. Lives as long as this object.
    std::span<const std::byte> bytes(size_t index);

private:
    std::unique_ptr<State> state_;
};

/// Dispatches and draws that go to the device in one submit. Each sees what the ones before it wrote.
///
///     CommandRun run(device);
///     run.dispatch(pipeline, {nodes, triangles, parameters, film}, bytesOfValue(push), groupsX, groupsY);
///     size_t film = run.read(filmBuffer);
///     Submission pass = run.submit();     // or double seconds = run.runAndWait();
class CommandRun {
public:
    explicit CommandRun(const Device& device);
    explicit CommandRun(Device::Context& context);
    ~CommandRun();
    CommandRun(CommandRun&&) noexcept;

    /// `bindings` in the order and of the kinds of the pipeline; push constants of exactly its size. Throws
    /// Error(invalidArgument) otherwise, and if there are more groups than the device can count. No groups:
    /// nothing.
    void dispatch(const ComputePipeline& pipeline, const std::vector<Binding>& bindings,
                  std::span<const std::byte> pushConstants, uint32_t groupsX, uint32_t groupsY = 1,
                  uint32_t groupsZ = 1);
    /// Clears the target to the integers `background` and depth 0, draws `vertices` / 3 triangles and
    /// copies the target's pixels, row by row from the top, to the start of `to`. Throws as dispatch, and
    /// Error(invalidArgument) if `to` is too small.
    void draw(const RasterPipeline& pipeline, const RasterTarget& target, const StorageBuffer& to,
              const std::vector<Binding>& bindings, std::span<const std::byte> pushConstants,
              uint32_t vertices, uint32_t background);
    /// Copies a buffer's bytes to the host after the dispatches so far. All of it if `bytes` is 0. Gives the
    /// index for Submission::bytes.
    size_t read(const StorageBuffer& from, uint64_t offset = 0, uint64_t bytes = 0);

    /// Hands everything to the device, uploads first. The run is empty afterwards and may be filled again.
    Submission submit();
    double runAndWait() { return submit().wait(); }

    struct Step;  // commands.cpp

private:
    Step& addStep(const std::shared_ptr<const PipelineState>& pipeline, const std::vector<Binding>& bindings,
                  std::span<const std::byte> pushConstants);

    Device::Context* context_;
    std::vector<Step> steps_;
};

}  // namespace tilefarm::gpu
