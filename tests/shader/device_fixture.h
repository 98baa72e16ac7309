#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "worker/vk/device.h"

namespace tilefarm {

/// Tests on the default device. With validation on (ctest turns it on) no message may be left at the end.
class DeviceTest : public testing::Test {
protected:
    DeviceTest() = default;
    explicit DeviceTest(const gpu::DeviceOptions& options) : device(gpu::defaultDevice(), options) {}

    void TearDown() override { EXPECT_THAT(device.validationMessages(), testing::IsEmpty()); }

    gpu::Device device{gpu::defaultDevice()};
};

}  // namespace tilefarm
