#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace tilefarm {

struct StreamLimits {
    std::chrono::milliseconds silence{60000};  // without a byte in or out
    std::chrono::milliseconds grace{30000};    // for a body of any size, and then
    uint64_t leastBytesPerSecond = 4u << 10;   // so many on average
};

/// What clients may take of a server, also those without a token.
struct HttpLimits {
    size_t connections = 1024;  // beyond, leases and /healthz are answered and others get 503
    size_t reserved = 128;      // threads for those
    size_t eventStreams = 512;  // each holds a connection; beyond, they get 503
    size_t headBytes = 64u << 10;
    std::chrono::milliseconds headTime{10000};       // from its first byte to its last
    std::chrono::milliseconds hurriedHeadTime{100};  // beyond `connections`
    StreamLimits body;
};

}  // namespace tilefarm
