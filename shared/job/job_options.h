#pragma once

#include <string>

#include "shared/job/job.h"

namespace CLI {
class App;
}

namespace tilefarm {

/// Adds an option for everything of a job that decides its picture (--width, --samples, --max-bounces,
/// --sky-turbidity, --light …), made from the table of fields that also reads the JSON. Values go into
/// `spec`; the scene's files and its frames are for the caller to ask for.
void addPictureOptions(CLI::App& app, JobSpec& spec);

/// The same, and what only a farm asks for: --name, --priority, --frames.
void addJobOptions(CLI::App& app, JobSpec& spec);

/// maxBounces -> --max-bounces
std::string optionName(std::string_view member);

}  // namespace tilefarm
