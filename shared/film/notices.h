#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/film/error_sums.h"
#include "shared/film/film.h"

namespace tilefarm {

/// Sentences for people: what light a job's picture lacks by its own rules, which is no fault. `paths`: all
/// that were begun. Empty where nothing is missing.
std::vector<std::string> noticesOf(const PassFaults& faults, uint64_t paths);

/// Likewise, where few pixels hold most of the error: which one to look at, and what may help.
std::vector<std::string> noticesOf(const ErrorEstimate& estimate);

}  // namespace tilefarm
