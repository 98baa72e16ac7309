#pragma once

#include <string>

namespace tilefarm {

/// Names the only parameter of a suite after the backend that it makes.
inline auto backendName(const char* backend) {
    return [backend](const auto&) { return std::string(backend); };
}

}  // namespace tilefarm
