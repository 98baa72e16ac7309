#include "worker/agent/backoff.h"

#include <algorithm>

namespace tilefarm {

Backoff::Backoff(Milliseconds first, Milliseconds most, uint32_t seed)
    : first_(first), most_(most), random_(seed) {}

Milliseconds Backoff::next() {
    const uint32_t doublings = std::min(failures_++, 20u);
    const Milliseconds wait = std::min(most_, first_ * (int64_t{1} << doublings));
    return jittered(wait * 3 / 4);
}

Milliseconds Backoff::jittered(Milliseconds time) {
    const double share = std::uniform_real_distribution<double>(1.0, 1.25)(random_);
    return Milliseconds(static_cast<int64_t>(static_cast<double>(time.count()) * share));
}

}  // namespace tilefarm
