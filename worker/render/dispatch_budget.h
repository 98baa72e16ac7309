#pragma once

#include <cstdint>

namespace tilefarm {

/// How many samples one dispatch may take, so that no driver's watchdog ends it (after about two seconds) and
/// yet few are needed. Samples are priced by their rays: `LightSelection::all` can ask for thousands. Where a
/// pass is cut does not show in its bits.
class DispatchBudget {
public:
    /// `cpu`: the device is a processor, whose dispatches nothing ends.
    DispatchBudget(bool cpu, uint32_t maxBounces);

    /// A surface point asks so many lights. Before any dispatch has told, this decides.
    void expect(uint64_t lightsAsked);
    /// Of a dispatch that has run.
    void measured(uint64_t rays, uint64_t samples);

    double raysPerSample() const;
    /// At least 1.
    uint64_t samples() const;

private:
    double budget_;  // rays
    double mostSamples_;
    double surfaces_;  // of a path, at a guess
    double expected_ = 1, measured_ = 0;
};

}  // namespace tilefarm
