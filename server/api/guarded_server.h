#pragma once

#include <httplib.h>

#include <atomic>
#include <optional>
#include <string>

#include "server/api/http_limits.h"
#include "server/api/request_head.h"

namespace tilefarm {

struct Services;

/// The library's server, with bounds on what it leaves open: the head of a request, how long that takes, how
/// many connections and event streams there are, how slow a body may be. Heads are read and checked here,
/// and refused before anything of the body is read; after a refusal the connection ends.
class GuardedServer : public httplib::Server {
public:
    GuardedServer(const Services& services, const HttpLimits& limits, std::chrono::milliseconds keepAlive)
        : services_(services), limits_(limits), keepAlive_(keepAlive) {}
    /// Lets more connections wait for their turn than the library does.
    void lengthenBacklog();

private:
    bool process_and_close_socket(socket_t socket) override;
    bool exchange(int fd, std::string& received, bool crowded, bool first);
    bool answer(int fd, std::string& received, const RequestHead& head, bool crowded);
    std::optional<std::string> refusalOf(const RequestHead& head, bool crowded) const;
    enum class Read { whole, nothing, tooSlow, tooLarge };
    Read readHead(int fd, std::string& received, bool crowded, bool first) const;
    bool stopping() const { return svr_sock_ == INVALID_SOCKET; }

    const Services& services_;
    const HttpLimits limits_;
    const std::chrono::milliseconds keepAlive_;
    std::atomic<size_t> connections_{0}, streams_{0};
};

}  // namespace tilefarm
