#pragma once

#include <string>

#include "shared/job/job.h"

namespace CLI {
class App;
}

namespace tilefarm {

/// Adds an option for every setting of a job (--width, --samples, --max-bounces, …), made from the
/// table of fields that also reads the JSON, and --frames. Values go into `spec`.
void addJobOptions(CLI::App& app, JobSpec& spec);

/// "7" or "1-240", either end with a sign. Throws Error(invalidArgument) that says what it should be.
FrameRange framesFrom(const std::string& text);

/// maxBounces -> --max-bounces
std::string optionName(std::string_view member);

}  // namespace tilefarm
