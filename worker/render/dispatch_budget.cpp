#include "worker/render/dispatch_budget.h"

#include <algorithm>

namespace tilefarm {
namespace {

// 0.2 s of an H200 at 1.3e9 rays/s, 2 s of a small GPU; long dispatches are best on lavapipe.
constexpr double kRaysPerDispatchGpu = 0x1p28;
constexpr double kRaysPerDispatchCpu = 0x1p26;
// Whatever the rays: a pixel's loop does more than trace.
constexpr double kSamplesPerDispatchGpu = 0x1p26;
constexpr double kSamplesPerDispatchCpu = 0x1p22;
// How long paths are that nothing is known of; the bounce limit may be a thousand.
constexpr double kUsualSurfaces = 4;
// What the next tile may cost more than the expensive ones so far: a first tile of sky says little of a room.
constexpr double kLeastOfExpected = 0.25;

}  // namespace

DispatchBudget::DispatchBudget(bool cpu, uint32_t maxBounces)
    : budget_(cpu ? kRaysPerDispatchCpu : kRaysPerDispatchGpu),
      mostSamples_(cpu ? kSamplesPerDispatchCpu : kSamplesPerDispatchGpu),
      surfaces_(std::min(maxBounces + 1.0, kUsualSurfaces)) {}

void DispatchBudget::expect(uint64_t lightsAsked) {
    expected_ = std::max(expected_, surfaces_ * (1 + static_cast<double>(lightsAsked)));
}

void DispatchBudget::measured(uint64_t rays, uint64_t samples) {
    if (samples > 0)
        measured_ = std::max(measured_, static_cast<double>(rays) / static_cast<double>(samples));
}

double DispatchBudget::raysPerSample() const {
    return measured_ > 0 ? std::max(measured_, kLeastOfExpected * expected_) : expected_;
}

uint64_t DispatchBudget::samples() const {
    return static_cast<uint64_t>(std::max(1.0, std::min(mostSamples_, budget_ / raysPerSample())));
}

}  // namespace tilefarm
