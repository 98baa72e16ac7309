#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>

#include "affine.comp.h"
#include "beyond.comp.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/expect_error.h"
#include "worker/vk/commands.h"

namespace tilefarm::gpu {
namespace {

using testing::HasSubstr;

std::vector<float> ramp(size_t count) {
    std::vector<float> values(count);
    std::iota(values.begin(), values.end(), 0.0f);
    return values;
}

std::vector<float> readFloats(const StorageBuffer& buffer, size_t count) {
    std::vector<float> values(count);
    buffer.read(std::as_writable_bytes(std::span(values)));
    return values;
}

class Vk : public DeviceTest {
protected:
    static constexpr uint32_t kCount = 1000, kGroups = (kCount + 63) / 64;

    ComputePipeline affine(uint32_t scale) {
        return {device,
                {.spirv = affine_comp,
                 .bindings = {BindingKind::texels, BindingKind::storage, BindingKind::uniform},
                 .constants = {0, scale},
                 .pushConstantBytes = 4,
                 .name = "affine"}};
    }
    TexelBuffer table(std::vector<float> texels) {
        return {device, TexelFormat::rgba32f, bytesOf(texels), "table"};
    }
    UniformBuffer count(uint32_t value) {
        UniformBuffer buffer(device, 4, "count");
        buffer.update(bytesOfValue(value));
        return buffer;
    }
};

TEST_F(Vk, DispatchesSeeWhatTheOnesBeforeThemWrote) {
    StorageBuffer values(device, kCount * 4, "values");
    values.upload(bytesOf(ramp(kCount)));
    const std::vector<Binding> bindings{table({10, 0, 0, 0, 20, 0, 0, 0}), values, count(kCount)};
    const auto doubled = affine(2), tripled = affine(3);
    CommandRun run(device);
    run.dispatch(doubled, bindings, bytesOfValue(0.5f), kGroups);
    run.dispatch(tripled, bindings, bytesOfValue(-1.0f), kGroups);
    EXPECT_GT(run.runAndWait(), 0.0);
    const auto result = readFloats(values, kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        const float added = i % 2 ? 20.0f : 10.0f;
        ASSERT_EQ(result[i], 3 * (2 * float(i) + added + 0.5f) + added - 1.0f);
    }
}

TEST_F(Vk, StorageStartsAsZerosAndCanBeZeroedAgain) {
    StorageBuffer values(device, 4096, "values");
    EXPECT_EQ(readFloats(values, 1024), std::vector<float>(1024, 0.0f));
    values.upload(bytesOf(ramp(1024)));
    EXPECT_EQ(readFloats(values, 1024), ramp(1024));
    values.zero();
    EXPECT_EQ(readFloats(values, 1024), std::vector<float>(1024, 0.0f));
}

TEST_F(Vk, UploadsLargerThanTheStagingMemoryArriveWhole) {
    const std::vector<float> large = ramp(21 << 20);  // 84 MiB
    StorageBuffer values(device, large.size() * 4, "values");
    values.upload(bytesOf(large));
    EXPECT_EQ(readFloats(values, large.size()), large);
}

TEST_F(Vk, PartsOfABufferAreWrittenAndReadAlone) {
    StorageBuffer values(device, 64, "values");
    values.upload(bytesOf(ramp(4)), 16);
    std::vector<float> part(3);
    values.read(std::as_writable_bytes(std::span(part)), 20);
    EXPECT_EQ(part, (std::vector<float>{1, 2, 3}));
}

TEST_F(Vk, AnUpdateDoesNotReachDispatchesInFlight) {
    StorageBuffer values(device, kCount * 4, "values");
    UniformBuffer parameters = count(kCount);
    const std::vector<Binding> bindings{table({1, 0, 0, 0}), values, parameters};
    const auto pipeline = affine(1);
    std::vector<Submission> flying;
    for (uint32_t n : {kCount, 10u, kCount}) {
        parameters.update(bytesOfValue(n));
        CommandRun run(device);
        run.dispatch(pipeline, bindings, bytesOfValue(0.0f), kGroups);
        flying.push_back(run.submit());
    }
    const auto result = readFloats(values, kCount);
    EXPECT_EQ(result[0], 3.0f);
    EXPECT_EQ(result[10], 2.0f);
    for (Submission& submission : flying) EXPECT_TRUE(submission.done());
}

TEST_F(Vk, ASubmissionReadsBackWhatStoodWhenTheReadWasRecorded) {
    StorageBuffer values(device, kCount * 4, "values");
    const std::vector<Binding> bindings{table({1, 0, 0, 0}), values, count(kCount)};
    const auto pipeline = affine(1);
    CommandRun run(device);
    run.dispatch(pipeline, bindings, bytesOfValue(0.0f), kGroups);
    const size_t first = run.read(values, 0, 4);
    run.dispatch(pipeline, bindings, bytesOfValue(0.0f), kGroups);
    const size_t second = run.read(values, 4, 4);
    Submission submission = run.submit();
    EXPECT_EQ(*reinterpret_cast<const float*>(submission.bytes(first).data()), 1.0f);
    EXPECT_EQ(*reinterpret_cast<const float*>(submission.bytes(second).data()), 2.0f);
}

TEST_F(Vk, ASubmissionKeepsWhatItUses) {
    Submission submission = [&] {
        StorageBuffer values(device, kCount * 4, "values");
        CommandRun run(device);
        run.dispatch(affine(1), {table({1, 0, 0, 0}), values, count(kCount)}, bytesOfValue(0.0f), kGroups);
        run.read(values);
        return run.submit();
    }();
    EXPECT_EQ(*reinterpret_cast<const float*>(submission.bytes(0).data()), 1.0f);
}

TEST_F(Vk, AnAbsentTexelBufferReadsAsOneZeroTexel) {
    const TexelBuffer absent = table({});
    EXPECT_EQ(absent.texels(), 1u);
    StorageBuffer values(device, 4, "values");
    CommandRun run(device);
    run.dispatch(affine(1), {absent, values, count(1)}, bytesOfValue(4.0f), 1);
    run.runAndWait();
    EXPECT_EQ(readFloats(values, 1)[0], 4.0f);
}

TEST_F(Vk, ADispatchOfNoGroupsDoesNothing) {
    StorageBuffer values(device, 4, "values");
    CommandRun run(device);
    run.dispatch(affine(1), {table({1, 0, 0, 0}), values, count(1)}, bytesOfValue(4.0f), 0);
    EXPECT_EQ(run.runAndWait(), 0.0);
    EXPECT_EQ(readFloats(values, 1)[0], 0.0f);
}

TEST_F(Vk, WhatDoesNotFitTheDeviceIsAnErrorThatNamesTheBuffer) {
    const Error error =
        errorOf([&] { StorageBuffer(device, device.limits().storageBytes + 4, "the film of the frame"); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_THAT(error.what(), HasSubstr("the film of the frame"));
}

TEST_F(Vk, WrongUseIsAnErrorNotAFault) {
    StorageBuffer values(device, 16, "values");
    const auto pipeline = affine(1);
    CommandRun run(device);
    const float nothing = 0;
    const auto push = bytesOfValue(nothing);
    const std::vector<Binding> good{table({}), values, count(1)}, wrongKind{values, values, count(1)};
    EXPECT_EQ(codeOf([&] { run.dispatch(pipeline, {values}, push, 1); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { run.dispatch(pipeline, wrongKind, push, 1); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { run.dispatch(pipeline, good, {}, 1); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { run.dispatch(pipeline, good, push, device.limits().groups[0] + 1); }),
              ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { values.upload(bytesOf(ramp(5))); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { run.read(values, 8, 12); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { TexelBuffer(device, TexelFormat::rgba32f, bytesOf(ramp(3)), "t"); }),
              ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { UniformBuffer(device, 16385, "u"); }), ErrorCode::invalidArgument);
}

TEST(VkDevices, TheDefaultDeviceIsListedAndUsable) {
    const auto devices = listDevices();
    ASSERT_LT(defaultDevice(), devices.size());
    EXPECT_TRUE(devices[defaultDevice()].usable);
    for (uint32_t i = 0; i < devices.size(); ++i) EXPECT_EQ(devices[i].index, i);
}

TEST(VkDevices, AnIndexThatIsNotThereNamesTheDevices) {
    const Error error = errorOf([] { Device(99); });
    EXPECT_EQ(error.code, ErrorCode::notFound);
    EXPECT_THAT(error.what(), HasSubstr(listDevices().front().name));
}

TEST(VkDevices, OldLavapipeIsKnownToBoundLoops) {
    EXPECT_TRUE(boundsLoops("llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"));
    EXPECT_FALSE(boundsLoops("llvmpipe Mesa 25.0.7-2~bpo12+1 (LLVM 15.0.6)"));
    EXPECT_FALSE(boundsLoops("radv Mesa 22.3.6 (LLVM 15.0.6)"));
    EXPECT_FALSE(boundsLoops("NVIDIA 580.159.04"));
    EXPECT_FALSE(boundsLoops("llvmpipe"));
}

TEST(VkDevices, ValidationMessagesMakeTheNextCallThrow) {
    Device device(defaultDevice(), {.validation = true});
    // A kernel that binds less than its code uses is legal to hand over and wrong.
    const Error error = errorOf([&] {
        ComputePipeline(device, {.spirv = affine_comp, .bindings = {BindingKind::texels}, .name = "short"});
    });
    EXPECT_EQ(error.code, ErrorCode::internal);
    EXPECT_THAT(error.what(), HasSubstr("Vulkan validation: "));
    EXPECT_THAT(device.validationMessages(), testing::Not(testing::IsEmpty()));
}

// Death tests run in a process of their own, so that the environment they set reaches a fresh loader.
TEST(VkDevicesDeathTest, WithoutADriverTheListIsEmptyAndOpeningIsAnError) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
            setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
            const bool right = listDevices().empty() &&
                               errorOf([] { defaultDevice(); }).code == ErrorCode::notFound &&
                               errorOf([] { Device(0); }).code == ErrorCode::notFound;
            _exit(right ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

// That the checks see anything: without this a clean run of the suite under them would say nothing.
TEST(VkDevicesDeathTest, GpuAssistedValidationSeesReadsBeyondABuffer) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            setenv("TILEFARM_VALIDATION", "gpu", 1);
            const Error error = errorOf([] {
                Device device(defaultDevice());
                const std::vector<float> texels(8);
                StorageBuffer values(device, 256, "values");
                const std::vector<Binding> bindings{
                    TexelBuffer(device, TexelFormat::rgba32f, bytesOf(texels), "table"), values};
                const ComputePipeline pipeline(device,
                                               {.spirv = beyond_comp,
                                                .bindings = {BindingKind::texels, BindingKind::storage},
                                                .name = "beyond"});
                CommandRun run(device);
                run.dispatch(pipeline, bindings, {}, 1);
                run.runAndWait();
                ComputePipeline(device, {.spirv = beyond_comp,
                                         .bindings = {BindingKind::texels, BindingKind::storage},
                                         .name = "next"});
            });
            std::fprintf(stderr, "%s\n", error.what());
            _exit(0);
        },
        testing::ExitedWithCode(0), "texel");
}

TEST(VkDevicesDeathTest, APipelineCacheSurvivesATornFile) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            const auto folder =
                std::filesystem::temp_directory_path() / fmt::format("tilefarm-cache-{}", getpid());
            useShaderCache(folder);
            const auto compile = [] {
                Device device(defaultDevice());
                ComputePipeline(
                    device, {.spirv = affine_comp,
                             .bindings = {BindingKind::texels, BindingKind::storage, BindingKind::uniform},
                             .pushConstantBytes = 4});
            };
            compile();
            size_t files = 0;
            for (const auto& entry : std::filesystem::directory_iterator(folder))
                if (entry.path().extension() == ".bin") {
                    ++files;
                    std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) - 1);
                }
            compile();
            compile();
            std::filesystem::remove_all(folder);
            _exit(files == 1 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace tilefarm::gpu
