#pragma once

#include <httplib.h>

#include <chrono>
#include <string>

#include "server/api/http_limits.h"

namespace tilefarm {

/// One exchange over a connected socket, as the HTTP library reads and writes it. Does not own the socket,
/// which must not block. Reading fails once the client is silent, or slower than the least rate.
class SocketStream : public httplib::Stream {
public:
    /// `received`: what was read of the socket before.
    SocketStream(int fd, std::string received, const StreamLimits& limits);

    bool is_readable() const override;
    bool is_writable() const override;
    ssize_t read(char* to, size_t size) override;
    ssize_t write(const char* from, size_t size) override;
    void get_remote_ip_and_port(std::string& ip, int& port) const override;
    void get_local_ip_and_port(std::string& ip, int& port) const override;
    /// None: the library refuses those above FD_SETSIZE, and has no need of it.
    socket_t socket() const override { return -1; }

    /// Whether a header of the response says that the connection ends with it.
    bool saidClose() const { return saidClose_; }
    /// What was read of the socket and not by the library: the beginning of the next request.
    std::string rest() const { return buffer_.substr(at_); }

private:
    bool waitFor(short events, std::chrono::steady_clock::time_point until) const;
    bool fill();

    const int fd_;
    const StreamLimits limits_;
    const std::chrono::steady_clock::time_point begin_;
    std::string buffer_;
    size_t at_ = 0;
    uint64_t received_ = 0;
    bool wrote_ = false, saidClose_ = false;
};

}  // namespace tilefarm
