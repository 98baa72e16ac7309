#pragma once

#include <filesystem>

#include "server/api/http_server.h"
#include "server/api/services.h"
#include "server/queue/scheduler.h"

namespace tilefarm {

/// What the command line says.
struct ServerConfig {
    std::filesystem::path data;
    HttpConfig http;
    ApiConfig api;
    QueueConfig queue;
    bool verbose = false;
};

/// Throws Error(invalidArgument) that names the option at fault. Exits the process for --help and
/// --version.
ServerConfig parseCommandLine(int argc, char** argv);

}  // namespace tilefarm
