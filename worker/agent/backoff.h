#pragma once

#include <cstdint>
#include <random>

#include "shared/clock/clock.h"

namespace tilefarm {

/// Waits that double from `first` to `most`, each shorter by up to a quarter by chance, so that the
/// workers of a farm do not all come back in the same moment.
class Backoff {
public:
    Backoff(Milliseconds first, Milliseconds most, uint32_t seed);
    Milliseconds next();
    void reset() { failures_ = 0; }
    /// How often next() was called since reset().
    uint32_t failures() const { return failures_; }
    /// `time` and up to a quarter more.
    Milliseconds jittered(Milliseconds time);

private:
    Milliseconds first_, most_;
    uint32_t failures_ = 0;
    std::minstd_rand random_;
};

}  // namespace tilefarm
