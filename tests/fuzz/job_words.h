#pragma once

#include <string>
#include <vector>

namespace tilefarm::fuzz {

/// Members and words of the job's schema, and some of leases and paths. From the schema itself, so that new
/// ones are tried as soon as they are there.
std::vector<std::string> jobWords();

}  // namespace tilefarm::fuzz
