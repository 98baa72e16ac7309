#include "server/api/http_server.h"

#include <httplib.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "server/api/connection_threads.h"
#include "server/api/guarded_server.h"
#include "server/api/problem.h"
#include "server/api/routes.h"
#include "server/api/services.h"

namespace tilefarm {
namespace {

constexpr uint64_t kMostDiscarded = 64u << 10;  // a connection with more unread is ended
constexpr size_t kPieceBytes = 256 << 10;
constexpr size_t kMostPathBytes = 1024;  // several times the longest route with its parameters

struct Threads : httplib::TaskQueue {
    ConnectionThreads threads;
    explicit Threads(size_t most) : threads(most) {}
    void enqueue(std::function<void()> task) override { threads.run(std::move(task)); }
    void shutdown() override { threads.stop(); }
};

bool hasBody(const httplib::Request& request) {
    return request.has_header("Content-Length") || request.has_header("Transfer-Encoding");
}

std::optional<uint64_t> contentLength(const httplib::Request& request) {
    const std::string text = request.get_header_value("Content-Length");
    if (text.empty() || text.size() > 18 || text.find_first_not_of("0123456789") != std::string::npos)
        return {};
    return std::stoull(text);
}

// Hands the body on exactly once. A consumer that throws is not called again, and a short rest is read and
// dropped: bytes left on the connection would be taken for the next request. After a long one it has to end.
class BodyReader {
public:
    BodyReader(const httplib::Request& request, const httplib::ContentReader* reader)
        : reader_(hasBody(request) ? reader : nullptr), bytes_(contentLength(request)) {}

    void read(const HttpRequest::Consumer& consumer) {
        if (reader_ == nullptr) return;
        std::exception_ptr fault;
        uint64_t discarded = 0;
        const auto* reader = std::exchange(reader_, nullptr);
        const bool whole = (*reader)([&](const char* data, size_t size) {
            if (fault) return (discarded += size) < kMostDiscarded;
            try {
                consumer(std::as_bytes(std::span(data, size)));
            } catch (...) {
                fault = std::current_exception();
            }
            return true;
        });
        leftUnread_ = !whole;
        if (fault) std::rethrow_exception(fault);
        if (!whole) throwIncomplete();
    }
    /// Whether bytes are left that nobody wants.
    bool leftUnread() const { return leftUnread_; }
    void discard() {
        if (reader_ != nullptr && bytes_.value_or(0) > kMostDiscarded) {
            leftUnread_ = true;
            return;
        }
        try {
            read([](std::span<const std::byte>) { throw Error(ErrorCode::internal, "not wanted"); });
        } catch (const Error&) {
        }
    }

private:
    // Of an announced length nothing but time can be wrong, and the client may try again.
    [[noreturn]] void throwIncomplete() const {
        if (bytes_)
            throw Error(ErrorCode::tooSlow,
                        "the body stopped, or was too slow, before its length was reached");
        throw Error(ErrorCode::invalidArgument, "the chunks of the body stopped or are malformed");
    }

    const httplib::ContentReader* reader_;
    std::optional<uint64_t> bytes_;
    bool leftUnread_ = false;
};

void sendContent(httplib::Response& out, const std::string& type, HttpResponse::Content content) {
    if (content.bytes == 0) return out.set_content("", type);  // a provider of nothing is asked for ever
    auto buffer = std::make_shared<std::vector<std::byte>>();
    out.set_content_provider(
        content.bytes, type, [content, buffer](size_t offset, size_t length, httplib::DataSink& sink) {
            buffer->resize(std::min(length, kPieceBytes));
            try {
                content.read(offset, *buffer);
            } catch (const std::exception& fault) {  // the head is out: all that is left is to hang up
                spdlog::error("sending a response failed: {}", fault.what());
                return false;
            }
            return sink.write(reinterpret_cast<const char*>(buffer->data()), buffer->size());
        });
}

void sendStream(httplib::Response& out, const std::string& type, HttpResponse::Stream next) {
    out.set_chunked_content_provider(type, [next](size_t, httplib::DataSink& sink) {
        try {
            const auto write = [&](std::string_view text) { return sink.write(text.data(), text.size()); };
            if (!sink.is_writable()) return false;
            if (!next(write)) sink.done();
            return true;
        } catch (const std::exception& fault) {
            spdlog::error("streaming a response failed: {}", fault.what());
            return false;
        }
    });
}

void send(HttpResponse response, httplib::Response& out) {
    out.status = response.status;
    for (const auto& [name, value] : response.headers) out.headers.emplace(name, value);
    if (auto* text = std::get_if<std::string>(&response.body)) {
        if (!response.type.empty()) out.set_content(*text, response.type);
    } else if (auto* content = std::get_if<HttpResponse::Content>(&response.body)) {
        sendContent(out, response.type, std::move(*content));
    } else {
        sendStream(out, response.type, std::move(std::get<HttpResponse::Stream>(response.body)));
    }
}

// As sent, so before percent-decoding, which only shortens it.
size_t pathBytes(const httplib::Request& request) {
    return std::min(request.target.find('?'), request.target.size());
}

// Ahead of all that the library matches by std::regex, which recurses once per character: a path that
// is too long is matched as "/" and refused in answer(), so that its body is read off the connection like
// any other. The library's own ideas about ranges and multipart bodies are kept out; both are answered here.
// What is left is the header Range, which it matches before it asks anybody: ConnectionThreads::kStackBytes.
httplib::Server::HandlerResponse beforeRouting(const httplib::Request& request, httplib::Response&) {
    auto& mutableRequest = const_cast<httplib::Request&>(request);
    mutableRequest.ranges.clear();
    mutableRequest.headers.erase("Content-Type");
    if (pathBytes(request) > kMostPathBytes) mutableRequest.path = "/";
    return httplib::Server::HandlerResponse::Unhandled;
}

HttpResponse pathTooLong() {
    return problemResponse(414, "the path of the URL exceeds " + std::to_string(kMostPathBytes) + " bytes");
}

void answer(Services& services, const httplib::Request& in, httplib::Response& out,
            const httplib::ContentReader* reader) {
    BodyReader body(in, reader);
    HttpRequest request;
    request.method = in.method;
    request.path = in.path;
    for (const auto& [name, value] : in.params) request.query.emplace(name, value);
    request.header = [&in](const std::string& name) { return in.get_header_value(name); };
    request.contentLength = contentLength(in);
    request.stream = [&body](const HttpRequest::Consumer& consumer) { body.read(consumer); };
    auto response = pathBytes(in) > kMostPathBytes ? pathTooLong() : dispatch(services, request);
    body.discard();
    if (body.leftUnread()) response.headers.emplace("Connection", "close");
    send(std::move(response), out);
}

// Without SO_REUSEPORT, which the library sets by itself: a second server on the port must be told.
void socketOptions(socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace

struct HttpServer::Impl {
    GuardedServer server;
    std::thread listener;
    Impl(const Services& services, const HttpConfig& config)
        : server(services, config.limits, std::chrono::seconds(config.keepAliveSeconds)) {}
};

HttpServer::HttpServer(Services& services, const HttpConfig& config)
    : impl_(std::make_unique<Impl>(services, config)) {
    auto& server = impl_->server;
    const size_t threads = config.limits.connections + config.limits.reserved;
    server.new_task_queue = [threads] { return new Threads(threads); };
    server.set_tcp_nodelay(true);
    server.set_socket_options(socketOptions);
    server.set_keep_alive_max_count(1 << 30);
    server.set_keep_alive_timeout(config.keepAliveSeconds);

    server.set_pre_routing_handler(beforeRouting);
    const auto plain = [&services](const httplib::Request& in, httplib::Response& out) {
        answer(services, in, out, nullptr);
    };
    const auto withBody = [&services](const httplib::Request& in, httplib::Response& out,
                                      const httplib::ContentReader& reader) {
        answer(services, in, out, &reader);
    };
    const char* const everything = "/.*";  // the routes table decides
    server.Get(everything, plain).Options(everything, plain);
    server.Post(everything, withBody).Put(everything, withBody).Patch(everything, withBody);
    server.Delete(everything, withBody);
    // Requests that the library itself refuses (a malformed head, too long a URI) get a problem as well.
    server.set_error_handler([](const httplib::Request&, httplib::Response& out) {
        const bool bare = out.body.empty() && !out.has_header("Content-Type") && out.status != 416;
        if (bare) send(problemResponse(out.status, "the request cannot be read"), out);
    });

    port_ = config.port == 0 ? server.bind_to_any_port(config.host)
                             : (server.bind_to_port(config.host, config.port) ? config.port : -1);
    if (port_ < 0) {
        throw Error(ErrorCode::unavailable, "cannot listen on " + config.host + ":" +
                                                std::to_string(config.port) +
                                                ": the port is taken, or the address is not of this machine");
    }
    server.lengthenBacklog();
    impl_->listener = std::thread([this] { impl_->server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::yield();
}

void HttpServer::stop() {
    impl_->server.stop();
}

HttpServer::~HttpServer() {
    stop();
    impl_->listener.join();
}

}  // namespace tilefarm
