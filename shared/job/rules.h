#pragma once

#include <string>

#include "shared/job/job.h"

namespace tilefarm {

class Faults;

// Rules between members. What already has a fault of its own is not judged again.

void checkJob(const JobSpec& job, Faults& faults);
/// Gives first, count and step of frames that are named by a list; a fault where they were given otherwise.
void settleFrames(FrameSet& frames, Faults& faults);
/// Gives a stop condition that names no samples its usual most.
void settleStop(StopCondition& stop, Faults& faults);
void checkAppearance(const MaterialOverride& material, const std::string& pointer, Faults& faults);

}  // namespace tilefarm
