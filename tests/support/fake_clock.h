#pragma once

#include "shared/clock/clock.h"

namespace tilefarm {

struct FakeClock : Clock {
    TimePoint time{Milliseconds{1'700'000'000'000}};
    TimePoint now() const override { return time; }
    void advance(Milliseconds by) { time += by; }
};

}  // namespace tilefarm
