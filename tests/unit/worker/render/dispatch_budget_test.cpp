#include "worker/render/dispatch_budget.h"

#include <gtest/gtest.h>

namespace tilefarm {
namespace {

TEST(DispatchBudget, OrdinaryScenesTakeLongDispatches) {
    DispatchBudget budget(true, 8);
    budget.expect(1);
    EXPECT_EQ(budget.samples(), uint64_t{1} << 22);
    budget.measured(10 << 20, 1 << 20);
    EXPECT_EQ(budget.samples(), uint64_t{1} << 22);
}

TEST(DispatchBudget, ManyLightsShortenTheFirstDispatch) {
    DispatchBudget few(false, 8), many(false, 8);
    few.expect(1);
    many.expect(1000);
    EXPECT_GT(few.samples(), 100 * many.samples());
    EXPECT_LE(static_cast<double>(many.samples()) * many.raysPerSample(), 0x1p28);
}

TEST(DispatchBudget, WhatWasMeasuredCounts) {
    DispatchBudget budget(false, 8);
    budget.expect(1);
    budget.measured(1'000'000, 1000);
    EXPECT_DOUBLE_EQ(budget.raysPerSample(), 1000);
    EXPECT_LE(static_cast<double>(budget.samples()) * 1000, 0x1p28);
    budget.measured(1000, 1000);
    EXPECT_DOUBLE_EQ(budget.raysPerSample(), 1000) << "a tile of sky does not promise another";
}

TEST(DispatchBudget, SkyFirstDoesNotHideTheLights) {
    DispatchBudget budget(false, 8);
    budget.expect(400);
    budget.measured(1000, 1000);
    EXPECT_GE(budget.raysPerSample(), 400);
}

TEST(DispatchBudget, OneSampleIsTheLeast) {
    DispatchBudget budget(false, 8);
    budget.measured(uint64_t{1} << 62, 1);
    EXPECT_EQ(budget.samples(), 1u);
}

}  // namespace
}  // namespace tilefarm
