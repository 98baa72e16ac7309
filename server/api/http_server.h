#pragma once

#include <memory>
#include <string>

#include "server/api/http_limits.h"

namespace tilefarm {

struct Services;

struct HttpConfig {
    std::string host = "127.0.0.1";
    int port = 0;              // 0: any free one
    int keepAliveSeconds = 1;  // an idle connection holds a thread, and a server that stops waits for it
    HttpLimits limits{};
};

/// Serves the routes table over HTTP/1.1. Binds in the constructor; throws Error(unavailable) that
/// names the address if it is taken or not of this machine.
class HttpServer {
public:
    HttpServer(Services& services, const HttpConfig& config);
    /// Stops, and waits for requests under way.
    ~HttpServer();
    int port() const { return port_; }
    void stop();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    int port_ = 0;
};

}  // namespace tilefarm
