#pragma once

#include <cstdint>

#include "shared/job/pass_schedule.h"

namespace tilefarm {

/// One pass of one tile on loan.
struct LeasedPass {
    uint32_t tile = 0;  // index in the job's TileGrid
    SampleRange samples;
    friend bool operator==(const LeasedPass&, const LeasedPass&) = default;
};

}  // namespace tilefarm
