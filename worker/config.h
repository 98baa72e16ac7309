#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "worker/local/render_command.h"

namespace tilefarm {

/// Which devices to use: one by its number, the best one (nothing given), or all.
struct DeviceChoice {
    std::optional<uint32_t> index;
    bool all = false;
};

struct AgentConfig {
    std::string server, token;
    DeviceChoice device;
    std::string name;  // empty: that of the host
    uint64_t cacheBytes = 0;
    double wantSeconds = 5;
};

struct RenderConfig {
    LocalRender render;
    DeviceChoice device;
    bool validation = false;
};

struct DevicesConfig {
    bool json = false;
};

struct WorkerConfig {
    std::filesystem::path cache;
    bool verbose = false;
    std::variant<AgentConfig, RenderConfig, DevicesConfig> command;
};

/// A command line that asks for nothing more than what has been printed, or that is wrong.
struct ExitNow {
    int code = 0;
};

/// Prints help or what is wrong, and then gives ExitNow: 0 for help, 2 for wrong usage.
std::variant<WorkerConfig, ExitNow> parseCommandLine(int argc, const char* const* argv);

}  // namespace tilefarm
