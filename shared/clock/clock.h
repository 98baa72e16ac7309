#pragma once

#include <chrono>

namespace tilefarm {

using Milliseconds = std::chrono::milliseconds;
/// Wall time since the Unix epoch in milliseconds, as the database stores it.
using TimePoint = std::chrono::sys_time<Milliseconds>;

/// The only source of time for logic, so that tests move it by hand (tests/support/fake_clock.h).
struct Clock {
    virtual ~Clock() = default;
    virtual TimePoint now() const = 0;
};

struct SystemClock : Clock {
    TimePoint now() const override {
        return std::chrono::time_point_cast<Milliseconds>(std::chrono::system_clock::now());
    }
};

}  // namespace tilefarm
