#include "server/api/guarded_server.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/api/problem.h"
#include "server/api/routes.h"
#include "server/api/socket_stream.h"

namespace tilefarm {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kBacklog = 1024;
constexpr milliseconds kLook{500};     // for the end of the server
constexpr milliseconds kLinger{2000};  // for a client to read why it was refused
constexpr size_t kReadBytes = 16 << 10;

// One more of something, as long as it lives.
class Counted {
public:
    explicit Counted(std::atomic<size_t>& count) : count_(count), now_(++count) {}
    ~Counted() { --count_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    size_t now() const { return now_; }

private:
    std::atomic<size_t>& count_;
    const size_t now_;
};

bool isReadable(int fd, milliseconds within) {
    pollfd wait{fd, POLLIN, 0};
    return poll(&wait, 1, static_cast<int>(within.count())) > 0;
}

// What keeps a farm going; all else may be asked again.
bool isUrgent(const RequestHead& head) {
    const auto path = head.path();
    return path == "/healthz" || (path.starts_with("/v1/leases") && !path.ends_with("/result"));
}

bool isEventStream(const RequestHead& head) {
    return head.method == "GET" && head.path().ends_with("/events");
}

// The library reads a body of these methods alone, and would take that of another for the next request.
bool mayHaveBody(const std::string& method) {
    return method == "POST" || method == "PUT" || method == "PATCH" || method == "DELETE";
}

std::string rawResponse(const HttpResponse& response) {
    const auto& body = std::get<std::string>(response.body);
    std::string text = "HTTP/1.1 " + std::to_string(response.status) + " Refused\r\n";
    for (const auto& [name, value] : response.headers) text += name + ": " + value + "\r\n";
    return text + "Content-Type: " + response.type + "\r\nContent-Length: " + std::to_string(body.size()) +
           "\r\nConnection: close\r\n\r\n" + body;
}

std::string rawProblem(int status, const std::string& detail) {
    return rawResponse(problemResponse(status, detail));
}

// Closing a socket with bytes unread would throw away what was sent: the client is left a while to read it.
void closeKindly(int fd, bool quickly) {
    shutdown(fd, SHUT_WR);
    const auto until = steady_clock::now() + kLinger;
    char piece[kReadBytes];
    while (!quickly && steady_clock::now() < until && isReadable(fd, milliseconds(100)))
        if (recv(fd, piece, sizeof piece, 0) == 0) break;
    close(fd);
}

void sendAll(int fd, const std::string& text) {
    SocketStream(fd, {}, {}).write(text.data(), text.size());
}

}  // namespace

void GuardedServer::lengthenBacklog() {
    ::listen(svr_sock_, kBacklog);
}

bool GuardedServer::process_and_close_socket(socket_t fd) {
    const Counted connection(connections_);
    const bool crowded = connection.now() > limits_.connections;
    fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
    std::string received;
    bool first = true;
    while (exchange(fd, received, crowded, std::exchange(first, false)) && !stopping()) continue;
    closeKindly(fd, crowded);
    return true;
}

// Whether another request may follow.
bool GuardedServer::exchange(int fd, std::string& received, bool crowded, bool first) {
    switch (readHead(fd, received, crowded, first)) {
        case Read::nothing: return false;
        case Read::tooSlow:
            sendAll(fd, rawProblem(408, "the head of the request took too long"));
            return false;
        case Read::tooLarge:
            sendAll(fd, rawProblem(431, "the head of the request is too large"));
            return false;
        case Read::whole: break;
    }
    std::optional<RequestHead> head;
    try {
        head = parseHead(std::string_view(received).substr(0, endOfHead(received)));
    } catch (const Error& fault) {
        sendAll(fd, rawResponse(problemResponse(fault)));
        return false;
    }
    return answer(fd, received, *head, crowded);
}

bool GuardedServer::answer(int fd, std::string& received, const RequestHead& head, bool crowded) {
    if (const auto refusal = refusalOf(head, crowded)) {
        sendAll(fd, *refusal);
        return false;
    }
    std::optional<Counted> stream;
    if (isEventStream(head) && stream.emplace(streams_).now() > limits_.eventStreams) {
        sendAll(fd, rawProblem(503, "too many event streams are open"));
        return false;
    }
    SocketStream socket(fd, std::move(received), limits_.body);
    bool closed = false;
    const bool well = process_request(socket, crowded, closed, {});
    received = socket.rest();
    return well && !closed && !crowded && !socket.saidClose();
}

std::optional<std::string> GuardedServer::refusalOf(const RequestHead& head, bool crowded) const {
    if (crowded && !isUrgent(head)) return rawProblem(503, "too many connections are open");
    if (!mayHaveBody(head.method) && (head.count("content-length") + head.count("transfer-encoding")) > 0 &&
        head.header("content-length") != "0")
        return rawProblem(400, head.method + " takes no body");
    if (auto refused = refusedWithoutToken(services_, head.path(), head.header("authorization")))
        return rawResponse(*refused);
    return std::nullopt;
}

// The first byte may be long in coming, the others may not.
GuardedServer::Read GuardedServer::readHead(int fd, std::string& received, bool crowded, bool first) const {
    const milliseconds headTime = crowded ? limits_.hurriedHeadTime : limits_.headTime;
    const bool hurried = crowded || 2 * connections_ > limits_.connections;
    auto until = steady_clock::now() + (first ? headTime : hurried ? milliseconds(0) : keepAlive_);
    bool begun = !received.empty();
    while (endOfHead(received) == std::string::npos) {
        if (received.size() >= limits_.headBytes) return Read::tooLarge;
        if (!received.empty() && !std::exchange(begun, true)) until = steady_clock::now() + headTime;
        const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
        if (left.count() < 0 || stopping()) return begun ? Read::tooSlow : Read::nothing;
        if (!isReadable(fd, std::min(left, kLook))) {
            if (left <= kLook) return begun ? Read::tooSlow : Read::nothing;
            continue;
        }
        char piece[kReadBytes];
        const ssize_t got = recv(fd, piece, std::min(sizeof piece, limits_.headBytes), 0);
        if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return Read::nothing;
        received.append(piece, static_cast<size_t>(std::max<ssize_t>(got, 0)));
    }
    return endOfHead(received) > limits_.headBytes ? Read::tooLarge : Read::whole;
}

}  // namespace tilefarm
