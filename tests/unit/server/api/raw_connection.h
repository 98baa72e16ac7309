#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

namespace tilefarm {

/// A client that says whatever it likes, as slowly as it likes.
class RawConnection {
public:
    explicit RawConnection(int port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(static_cast<uint16_t>(port));
        inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
        if (connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
            throw std::runtime_error("cannot connect");
    }
    ~RawConnection() { close(fd_); }
    RawConnection(RawConnection&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    RawConnection& operator=(RawConnection&&) = delete;

    /// Whether the server still takes it all.
    bool send(const std::string& text) {
        for (size_t at = 0; at < text.size();) {
            const ssize_t sent = ::send(fd_, text.data() + at, text.size() - at, MSG_NOSIGNAL);
            if (sent <= 0) return false;
            at += static_cast<size_t>(sent);
        }
        return true;
    }
    /// What comes until the server hangs up, `until` was seen or `seconds` have passed without a byte.
    std::string receive(const std::string& until = "", int seconds = 20) {
        std::string text;
        char piece[4096];
        while (until.empty() || text.find(until) == std::string::npos) {
            pollfd wait{fd_, POLLIN, 0};
            if (poll(&wait, 1, seconds * 1000) <= 0) return text + "(nothing more)";
            const ssize_t got = recv(fd_, piece, sizeof piece, 0);
            if (got <= 0) return text;
            text.append(piece, static_cast<size_t>(got));
        }
        return text;
    }

private:
    int fd_;
};

}  // namespace tilefarm
