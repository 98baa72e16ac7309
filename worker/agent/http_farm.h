#pragma once

#include <memory>
#include <string>

#include "worker/agent/farm.h"

namespace tilefarm {

/// The Farm behind the REST API at `url`. Throws Error(invalidArgument) if that is no URL.
std::unique_ptr<Farm> makeHttpFarm(const std::string& url, const std::string& token);

}  // namespace tilefarm
