#include "server/api/socket_stream.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace tilefarm {
namespace {

using std::chrono::steady_clock;

constexpr size_t kBufferBytes = 64 << 10;

void addressOf(const sockaddr_storage& from, std::string& ip, int& port) {
    char text[INET6_ADDRSTRLEN] = "";
    if (from.ss_family == AF_INET) {
        const auto& v4 = reinterpret_cast<const sockaddr_in&>(from);
        inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
        port = ntohs(v4.sin_port);
    } else if (from.ss_family == AF_INET6) {
        const auto& v6 = reinterpret_cast<const sockaddr_in6&>(from);
        inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
        port = ntohs(v6.sin6_port);
    }
    ip = text;
}

// The library, and so do we, writes header names in this case.
bool saysClose(std::string_view head) {
    const size_t end = head.find("\r\n\r\n");
    return head.substr(0, end).find("\r\nConnection: close") != std::string_view::npos;
}

}  // namespace

SocketStream::SocketStream(int fd, std::string received, const StreamLimits& limits)
    : fd_(fd), limits_(limits), begin_(steady_clock::now()), buffer_(std::move(received)) {}

bool SocketStream::waitFor(short events, steady_clock::time_point until) const {
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - steady_clock::now());
        if (left.count() <= 0) return false;
        pollfd wait{fd_, events, 0};
        const int ready = poll(&wait, 1, static_cast<int>(left.count()));
        if (ready > 0) return true;
        if (ready == 0 || errno != EINTR) return false;
    }
}

bool SocketStream::is_readable() const {
    return at_ < buffer_.size() || waitFor(POLLIN, steady_clock::now() + limits_.silence);
}

bool SocketStream::is_writable() const {
    char byte = 0;
    const ssize_t got = recv(fd_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    const bool gone = got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    return !gone && waitFor(POLLOUT, steady_clock::now() + limits_.silence);
}

bool SocketStream::fill() {
    const auto earned = std::chrono::milliseconds(1000 * received_ / limits_.leastBytesPerSecond);
    const auto until = std::min(begin_ + limits_.grace + earned, steady_clock::now() + limits_.silence);
    buffer_.resize(kBufferBytes);
    at_ = 0;
    ssize_t got = -1;
    if (steady_clock::now() < until) {
        do {
            got = recv(fd_, buffer_.data(), buffer_.size(), 0);
        } while (got < 0 &&
                 (errno == EINTR || ((errno == EAGAIN || errno == EWOULDBLOCK) && waitFor(POLLIN, until))));
    }
    buffer_.resize(static_cast<size_t>(std::max<ssize_t>(got, 0)));
    received_ += buffer_.size();
    return got > 0;
}

ssize_t SocketStream::read(char* to, size_t size) {
    if (at_ == buffer_.size() && !fill()) return -1;
    const size_t got = std::min(size, buffer_.size() - at_);
    std::copy_n(buffer_.data() + at_, got, to);
    at_ += got;
    return static_cast<ssize_t>(got);
}

// All of it or nothing: a piece of a response is at most a few hundred kilobytes.
ssize_t SocketStream::write(const char* from, size_t size) {
    if (!std::exchange(wrote_, true)) saidClose_ = saysClose({from, size});
    const auto until = steady_clock::now() + limits_.silence;
    for (size_t sent = 0; sent < size;) {
        const ssize_t more = send(fd_, from + sent, size - sent, MSG_NOSIGNAL);
        if (more > 0)
            sent += static_cast<size_t>(more);
        else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            if (!waitFor(POLLOUT, until)) return -1;
        } else if (errno != EINTR)
            return -1;
    }
    return static_cast<ssize_t>(size);
}

void SocketStream::get_remote_ip_and_port(std::string& ip, int& port) const {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    if (getpeername(fd_, reinterpret_cast<sockaddr*>(&from), &size) == 0) addressOf(from, ip, port);
}

void SocketStream::get_local_ip_and_port(std::string& ip, int& port) const {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    if (getsockname(fd_, reinterpret_cast<sockaddr*>(&from), &size) == 0) addressOf(from, ip, port);
}

}  // namespace tilefarm
