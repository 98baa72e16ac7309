#include "shared/farm_client/farm_client.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <httplib.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <exception>
#include <nlohmann/json.hpp>
#include <regex>

#include "shared/farm_client/http_status.h"
#include "shared/file/durable_file.h"
#include "shared/job/wire.h"

namespace tilefarm {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::chrono::seconds kConnectTimeout{5}, kTransferTimeout{60};
constexpr size_t kBlockBytes = 1 << 20;
constexpr size_t kLongestProblem = 1 << 20;

std::string checkedUrl(std::string url) {
    while (!url.empty() && url.back() == '/') url.pop_back();
    static const std::regex form(R"(https?://([A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]{1,5})?)");
    if (!std::regex_match(url, form))
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("'{}' is no server URL like http://host:port", url));
    return url;
}

std::string wordFor(httplib::Error error) {
    switch (error) {
        case httplib::Error::Connection: return "the connection is refused or the host not known";
        case httplib::Error::ConnectionTimeout: return "connecting took too long";
        case httplib::Error::Read: return "it closed the connection or took too long to answer";
        case httplib::Error::Write: return "it closed the connection while the request was sent";
        case httplib::Error::SSLConnection:
        case httplib::Error::SSLLoadingCerts:
        case httplib::Error::SSLServerVerification: return "the TLS handshake failed";
        default: return httplib::to_string(error);
    }
}

// A file open for reading; the descriptor is read at offsets, as httplib asks for them.
class Source {
public:
    explicit Source(const fs::path& path) : path_(path), fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (fd_ < 0) throw fileError("read", path_, errno);
    }
    ~Source() { close(fd_); }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    std::span<const char> read(size_t offset, size_t length) {
        block_.resize(std::min(length, kBlockBytes));
        const ssize_t n = pread(fd_, block_.data(), block_.size(), static_cast<off_t>(offset));
        if (n < 0) throw fileError("read", path_, errno);
        if (n == 0)
            throw Error(ErrorCode::conflict,
                        fmt::format("'{}' became shorter while it was sent", path_.string()));
        return {block_.data(), static_cast<size_t>(n)};
    }

private:
    fs::path path_;
    int fd_;
    std::vector<char> block_;
};

uint32_t retryAfterMs(const httplib::Response& answer) {
    const auto number = [&](const char* header, uint32_t& out) {
        const std::string text = answer.get_header_value(header);
        return std::from_chars(text.data(), text.data() + text.size(), out).ec == std::errc{};
    };
    uint32_t value = 0;
    if (number("Tilefarm-Retry-After-Ms", value)) return value;
    if (number("Retry-After", value) && value <= 3600) return value * 1000;
    return NoWork{}.retryAfterMs;
}

}  // namespace

struct FarmClient::Impl {
    std::string url;
    httplib::Client http;

    Impl(std::string serverUrl, const std::string& token) : url(checkedUrl(std::move(serverUrl))), http(url) {
        // httplib writes to sockets without MSG_NOSIGNAL: a server that goes away must not end us.
        std::signal(SIGPIPE, SIG_IGN);
        if (!http.is_valid())
            throw Error(ErrorCode::invalidArgument, fmt::format("'{}' is no server URL", url));
        http.set_keep_alive(true);
        http.set_tcp_nodelay(true);
        http.set_connection_timeout(kConnectTimeout);
        http.set_read_timeout(kTransferTimeout);
        http.set_write_timeout(kTransferTimeout);
        http.set_url_encode(false);  // percentEncoded does it where it is due
        if (!token.empty()) http.set_bearer_token_auth(token);
    }

    /// The answer, whatever its status.
    httplib::Response exchange(const httplib::Request& request) {
        httplib::Response answer;
        httplib::Error error = httplib::Error::Success;
        httplib::Request sent = request;
        if (http.send(sent, answer, error)) return answer;
        throw Error(ErrorCode::unavailable, fmt::format("cannot reach the server at {} ({} {}): {}", url,
                                                        request.method, request.path, wordFor(error)));
    }

    /// The answer, if it is a success.
    httplib::Response successful(const httplib::Request& request) {
        httplib::Response answer = exchange(request);
        if (answer.status < 200 || answer.status > 299) throw errorOf(answer.status, answer.body, request);
        return answer;
    }

    Error errorOf(int status, const std::string& body, const httplib::Request& request) const {
        return errorOfAnswer(status, body, fmt::format("{} {}{}", request.method, url, request.path));
    }

    static httplib::Request request(std::string method, std::string path) {
        httplib::Request request;
        request.method = std::move(method);
        request.path = std::move(path);
        return request;
    }

    static httplib::Request postOf(std::string path, const json& body) {
        httplib::Request post = request("POST", std::move(path));
        post.set_header("Content-Type", "application/json");
        post.body = body.dump(-1, ' ', false, json::error_handler_t::replace);
        return post;
    }

    /// Reads an answer with `read`; an unexpected one is the server's error, not the caller's.
    template <typename Read>
    auto understood(const httplib::Response& answer, Read&& read) {
        try {
            return read(parseJson(answer.body));
        } catch (const Error& e) {
            throw Error(ErrorCode::internal, fmt::format("{} sent an unexpected answer: {}", url, e.what()));
        } catch (const json::exception& e) {
            throw Error(ErrorCode::internal, fmt::format("{} sent an unexpected answer: {}", url, e.what()));
        }
    }

    json get(const std::string& path) { return whole(request("GET", path)); }
    json post(const std::string& path, const json& body) { return whole(postOf(path, body)); }
    json whole(const httplib::Request& request) {
        return understood(successful(request), [](json answer) { return answer; });
    }

    /// Streams `length` bytes that `read(offset, length)` gives; a fault of it is thrown on.
    template <typename Read>
    httplib::Response put(const std::string& path, const httplib::Headers& headers, size_t length,
                          Read&& read) {
        std::exception_ptr fault;
        httplib::Request put = request("PUT", path);
        put.headers = headers;
        put.set_header("Content-Type", "application/octet-stream");
        if (length == 0) {
            put.set_header("Content-Length", "0");
            return successful(put);
        }
        put.content_length_ = length;
        put.content_provider_ = [&](size_t offset, size_t left, httplib::DataSink& sink) {
            try {
                const std::span<const char> block = read(offset, left);
                return sink.write(block.data(), block.size());
            } catch (...) {
                fault = std::current_exception();
                return false;
            }
        };
        try {
            return successful(put);
        } catch (const Error&) {
            if (fault) std::rethrow_exception(fault);
            throw;
        }
    }

    /// Streams the answer of a GET into a file that is whole or absent.
    void getFile(const std::string& path, const fs::path& file) {
        DurableFile out(file);
        std::exception_ptr fault;
        int status = 0;
        std::string problem;
        httplib::Request get = request("GET", path);
        get.response_handler = [&](const httplib::Response& answer) {
            status = answer.status;
            return true;
        };
        get.content_receiver = [&](const char* data, size_t size, uint64_t, uint64_t) {
            if (status != 200) {
                problem.append(data, std::min(size, kLongestProblem - problem.size()));
                return true;
            }
            try {
                out.write(std::string_view(data, size));
                return true;
            } catch (...) {
                fault = std::current_exception();
                return false;
            }
        };
        try {
            exchange(get);
        } catch (const Error&) {
            if (fault) std::rethrow_exception(fault);
            throw;
        }
        if (status != 200) throw errorOf(status, problem, get);
        out.commit();
    }
};

namespace {

std::string blobPath(const std::string& sha256) {
    return "/v1/blobs/" + percentEncoded(sha256);
}
std::string jobPath(const std::string& id, const char* action = "") {
    return "/v1/jobs/" + percentEncoded(id) + action;
}
std::string leasePath(const std::string& id, const char* action) {
    return "/v1/leases/" + percentEncoded(id) + action;
}

}  // namespace

FarmClient::FarmClient(std::string url, std::string token)
    : impl_(std::make_unique<Impl>(std::move(url), token)) {}
FarmClient::~FarmClient() = default;

std::vector<std::string> FarmClient::missingBlobs(const std::vector<std::string>& digests) {
    return impl_->understood(
        impl_->successful(Impl::postOf("/v1/blobs/missing", {{"sha256", digests}})),
        [](const json& answer) { return answer.at("missing").get<std::vector<std::string>>(); });
}

void FarmClient::putBlob(const std::string& sha256, const fs::path& file) {
    Source source(file);
    impl_->put(blobPath(sha256), {}, fs::file_size(file),
               [&](size_t offset, size_t length) { return source.read(offset, length); });
}

void FarmClient::getBlob(const std::string& sha256, const fs::path& file) {
    impl_->getFile(blobPath(sha256), file);
}

json FarmClient::submit(const JobSpec& spec, const std::string& idempotencyKey) {
    httplib::Request post = Impl::postOf("/v1/jobs", toJson(spec));
    if (!idempotencyKey.empty()) post.set_header("Idempotency-Key", idempotencyKey);
    return impl_->whole(post);
}
json FarmClient::validate(const JobSpec& spec) {
    return impl_->post("/v1/jobs?validate=only", toJson(spec));
}
json FarmClient::startForecast(const JobSpec& spec) {
    return impl_->post("/v1/forecasts", {{"job", toJson(spec)}});
}
json FarmClient::forecast(const std::string& path) {
    return impl_->get(path);
}
json FarmClient::jobs(const std::string& query) {
    return impl_->get("/v1/jobs" + (query.empty() ? "" : "?" + query));
}
json FarmClient::job(const std::string& id) {
    return impl_->get(jobPath(id));
}
json FarmClient::cancel(const std::string& id) {
    return impl_->post(jobPath(id, "/cancel"), json::object());
}
json FarmClient::pause(const std::string& id) {
    return impl_->post(jobPath(id, "/pause"), json::object());
}
json FarmClient::resume(const std::string& id) {
    return impl_->post(jobPath(id, "/resume"), json::object());
}
json FarmClient::workers() {
    return impl_->get("/v1/workers");
}
json FarmClient::submitStudy(const json& request) {
    return impl_->post("/v1/studies", request);
}
json FarmClient::study(const std::string& id) {
    return impl_->get("/v1/studies/" + percentEncoded(id));
}
json FarmClient::studies(const std::string& query) {
    return impl_->get("/v1/studies" + (query.empty() ? "" : "?" + query));
}
json FarmClient::cancelStudy(const std::string& id) {
    return impl_->post("/v1/studies/" + percentEncoded(id) + "/cancel", json::object());
}
void FarmClient::download(const std::string& path, const fs::path& file) {
    impl_->getFile(path, file);
}

std::variant<Lease, NoWork> FarmClient::lease(const WorkerHello& hello, double wantSeconds) {
    json body = toJson(hello);
    body["wantSeconds"] = wantSeconds;
    const httplib::Response answer = impl_->successful(Impl::postOf("/v1/leases", body));
    if (answer.status == 204) return NoWork{retryAfterMs(answer)};
    return impl_->understood(answer, [](const json& lease) { return leaseFromJson(lease); });
}

void FarmClient::renew(const std::string& leaseId, uint64_t epoch) {
    impl_->successful(Impl::postOf(leasePath(leaseId, "/renew"), {{"epoch", epoch}}));
}

ResultReceipt FarmClient::upload(const ResultUpload& result) {
    const std::string path = leasePath(result.leaseId, "/result") +
                             fmt::format("?epoch={}&deviceSeconds={}", result.epoch, result.deviceSeconds);
    const auto bytes = std::span(reinterpret_cast<const char*>(result.exr.data()), result.exr.size());
    const httplib::Response answer = impl_->put(
        path, {{"Content-Digest", contentDigest(result.sha256)}}, bytes.size(),
        [&](size_t offset, size_t length) { return bytes.subspan(offset, std::min(length, kBlockBytes)); });
    return impl_->understood(answer, [](const json& receipt) { return receiptFromJson(receipt); });
}

void FarmClient::handBack(const std::string& leaseId, uint64_t epoch) {
    impl_->successful(Impl::postOf(leasePath(leaseId, "/return"), {{"epoch", epoch}}));
}

void FarmClient::reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message) {
    impl_->successful(Impl::postOf(leasePath(leaseId, "/failure"), {{"epoch", epoch}, {"message", message}}));
}

void FarmClient::reportScene(const std::string& leaseId, uint64_t epoch, const json& report) {
    json body = report;
    body["epoch"] = epoch;
    impl_->successful(Impl::postOf(leasePath(leaseId, "/report"), body));
}

}  // namespace tilefarm
