#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tilefarm {

/// A request as the resources see it; http_server.cpp makes it of the HTTP library's.
class HttpRequest {
public:
    using Consumer = std::function<void(std::span<const std::byte>)>;

    std::string method, path;
    std::map<std::string, std::string> parameters;  // of the route's pattern
    std::map<std::string, std::string> query;
    std::function<std::string(const std::string& name)> header;  // "" where absent
    std::optional<uint64_t> contentLength;
    std::function<void(const Consumer&)> stream;  // hands over the body, once

    const std::string& parameter(const std::string& name) const { return parameters.at(name); }
    std::optional<std::string> queried(const std::string& name) const;
    /// Throw Error(invalidArgument) that names the parameter if it is missing or no number in range.
    uint64_t queriedInteger(const std::string& name, uint64_t least, uint64_t most,
                            std::optional<uint64_t> otherwise = {}) const;
    double queriedNumber(const std::string& name, double least, double most,
                         std::optional<double> otherwise = {}) const;
    /// 1 or 0; false if it is missing. Throws Error(invalidArgument) that names the parameter for others.
    bool queriedFlag(const std::string& name) const;

    /// Streams the body. Throws Error(tooLarge) once it exceeds `mostBytes`.
    void readBody(uint64_t mostBytes, const Consumer& consumer);
    std::string body(uint64_t mostBytes);
};

/// Where an endless response goes; false once the client is gone or the server stops.
using StreamSink = std::function<bool(std::string_view)>;

struct HttpResponse {
    /// Bytes given out in pieces: [offset, offset + into.size()).
    struct Content {
        uint64_t bytes = 0;
        std::function<void(uint64_t offset, std::span<std::byte> into)> read;
    };
    /// Called again and again until it returns false.
    using Stream = std::function<bool(const StreamSink&)>;

    int status = 200;
    std::string type = "application/json";
    std::multimap<std::string, std::string> headers;
    std::variant<std::string, Content, Stream> body;
};

HttpResponse jsonResponse(int status, std::string json);
HttpResponse emptyResponse(int status);

/// GET and HEAD of immutable bytes: ETag, If-None-Match (304), Range (206, 416), If-Range.
HttpResponse contentResponse(const HttpRequest& request, std::string type, const std::string& sha256,
                             HttpResponse::Content content);

}  // namespace tilefarm
