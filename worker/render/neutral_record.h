#pragma once

#include <cstdint>

#include "shaders/gpu_types.h"

namespace tilefarm {

/// Makes every effect of the record that is not among `called`, the FEATURE_* that its own material calls
/// for, one without effect. Then a material looks the same in every kernel that holds at least those
/// features: what other materials have compiled in finds nothing in its record. The one place that decides
/// this; a new feature of materials has its line here (tests/shader/feature_union_test.cpp fails without).
void neutralise(gpu::MaterialRecord& record, uint64_t called);

}  // namespace tilefarm
