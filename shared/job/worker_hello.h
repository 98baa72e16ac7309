#pragma once

#include <string>
#include <vector>

namespace tilefarm {

/// What a worker says of itself when it asks for work.
struct WorkerHello {
    std::string worker;     // stable id, unique per process and device
    std::string host;       // for people
    std::string device;     // Vulkan device name
    std::string driver;     // driver name and version
    std::string version;    // TILEFARM_VERSION
    std::string session{};  // its process, the same for all of its devices; empty: the worker itself
    /// Sessions on this machine that were killed or crashed: their leases are lost at once.
    std::vector<std::string> ended{};
    friend bool operator==(const WorkerHello&, const WorkerHello&) = default;
};

}  // namespace tilefarm
