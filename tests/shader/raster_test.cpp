// Drawing through worker/vk: coverage, depth, both sides, background, order of work.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>

#include "flat.frag.h"
#include "flat.vert.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/expect_error.h"
#include "worker/vk/commands.h"

namespace tilefarm::gpu {
namespace {

using testing::HasSubstr;

constexpr uint32_t kWidth = 8, kHeight = 4, kBackground = 0xffffffffu;

class RasterTest : public testing::Test {
protected:
    void TearDown() override { EXPECT_THAT(device.validationMessages(), testing::IsEmpty()); }

    RasterPipeline flat(uint32_t added = 0) {
        return {device,
                {.spirv = flat_vert,
                 .bindings = {BindingKind::texels},
                 .constants = {added},
                 .pushConstantBytes = 4,
                 .name = "flat"},
                flat_frag};
    }

    /// Four integers per pixel of what is drawn from (x, y, depth, number) per vertex.
    std::vector<glm::uvec4> drawn(const std::vector<glm::vec4>& vertices, uint32_t added = 0) {
        const RasterTarget target(device, kWidth, kHeight, "target");
        StorageBuffer to(device, target.bytes(), "pixels");
        CommandRun run(device);
        run.draw(flat(added), target, to, {TexelBuffer(device, TexelFormat::rgba32f, bytesOf(vertices), "v")},
                 bytesOfValue(uint32_t{77}), static_cast<uint32_t>(vertices.size()), kBackground);
        run.runAndWait();
        std::vector<glm::uvec4> pixels(kWidth * kHeight);
        to.read(std::as_writable_bytes(std::span(pixels)));
        return pixels;
    }

    Device device{defaultDevice(), {.graphics = true}};
};

/// Covers the left half of the image, seen from the front or the back.
std::vector<glm::vec4> leftHalf(float depth, float number, bool back = false) {
    std::vector<glm::vec4> corners{{-1, -1, depth, number}, {-1, 3, depth, number}, {0, -1, depth, number},
                                   {0, -1, depth, number},  {-1, 3, depth, number}, {0, 3, depth, number}};
    if (back) std::swap(corners[0], corners[1]), std::swap(corners[3], corners[4]);
    return corners;
}

TEST_F(RasterTest, CoversThePixelsWhoseCentresLieInside) {
    const auto pixels = drawn(leftHalf(0.5f, 5), 100);
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const glm::uvec4 expected =
                x < kWidth / 2 ? glm::uvec4(5, 105, 77, 0x3f000000u) : glm::uvec4(kBackground);
            EXPECT_EQ(pixels[y * kWidth + x], expected) << x << ", " << y;
        }
}

TEST_F(RasterTest, KeepsTheNearestWhateverTheOrderAndTheSide) {
    for (const bool back : {false, true}) {
        auto both = leftHalf(0.25f, 1, back);
        const auto near = leftHalf(0.75f, 2, !back);
        both.insert(both.end(), near.begin(), near.end());
        EXPECT_EQ(drawn(both)[0].x, 2u);
        std::rotate(both.begin(), both.begin() + 6, both.end());
        EXPECT_EQ(drawn(both)[0].x, 2u);
    }
}

TEST_F(RasterTest, NoTrianglesLeaveTheBackground) {
    for (const glm::uvec4& pixel : drawn({})) EXPECT_EQ(pixel, glm::uvec4(kBackground));
}

TEST_F(RasterTest, RefusesWhatDoesNotFit) {
    EXPECT_THAT(errorOf([&] { RasterTarget(device, 0, 4, "empty"); }).what(), HasSubstr("0 x 4"));
    EXPECT_THAT(errorOf([&] { RasterTarget(device, 1u << 20, 4, "huge"); }).what(), HasSubstr("1048576 x 4"));
    const RasterTarget target(device, kWidth, kHeight, "target");
    const StorageBuffer small(device, 16, "small");
    CommandRun run(device);
    EXPECT_THAT(errorOf([&] { run.draw(flat(), target, small, {}, bytesOfValue(0u), 0, 0); }).what(),
                HasSubstr("small"));
}

}  // namespace
}  // namespace tilefarm::gpu
