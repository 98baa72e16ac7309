#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/store/rows.h"

namespace tilefarm {

/// Whether samples of the job were NaN or infinite, so that its image is one of the other samples alone, or
/// paths ended that should not have.
bool isFlagged(const JobRow& job);

/// Sentences for people: why a job failed, and what its image lacks.
std::vector<std::string> faultsOf(const JobRow& job);

/// Likewise: what light the image lacks by the job's own rules.
std::vector<std::string> noticesOf(const JobRow& job);

/// Counts, and the first dropped samples with all that it takes to render each again alone.
nlohmann::json numericsOf(const JobRow& job);

}  // namespace tilefarm
