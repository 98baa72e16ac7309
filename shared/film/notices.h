#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/film/film.h"

namespace tilefarm {

/// Sentences for people: what light a job's picture lacks by its own rules, which is no fault. `paths`: all
/// that were begun. Empty where nothing is missing.
std::vector<std::string> noticesOf(const PassFaults& faults, uint64_t paths);

}  // namespace tilefarm
