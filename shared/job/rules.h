#pragma once

#include <string>

#include "shared/job/job.h"

namespace tilefarm {

class Faults;

// Rules between members. What already has a fault of its own is not judged again.

void checkJob(const JobSpec& job, Faults& faults);
void checkAppearance(const MaterialOverride& material, const std::string& pointer, Faults& faults);

}  // namespace tilefarm
