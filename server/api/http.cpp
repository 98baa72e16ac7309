#include "server/api/http.h"

#include <charconv>
#include <cmath>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

[[noreturn]] void badQuery(const std::string& name, const std::string& message) {
    throw Error(ErrorCode::invalidArgument, "query parameter '" + name + "' " + message, {{name, message}});
}

template <typename Number>
std::optional<Number> parse(const std::string& text) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [at, fault] = std::from_chars(text.data(), end, value);
    return fault == std::errc{} && at == end && !text.empty() ? std::optional(value) : std::nullopt;
}

template <typename Number>
Number queriedAs(const HttpRequest& request, const std::string& name, Number least, Number most,
                 std::optional<Number> otherwise) {
    const auto text = request.queried(name);
    if (!text && otherwise) return *otherwise;
    if (!text) badQuery(name, "is missing");
    const auto value = parse<Number>(*text);
    if (!value || !(*value >= least && *value <= most)) {
        badQuery(name, "must be a number from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return *value;
}

struct ByteRange {
    uint64_t first = 0, last = 0;
};

// The first range of a Range header. Nothing: the header is not understood and is ignored (RFC 9110
// 14.2); several ranges are answered with the whole.
std::optional<ByteRange> parseRange(const std::string& header, uint64_t bytes) {
    const std::string unit = "bytes=";
    if (!header.starts_with(unit) || header.find(',') != std::string::npos) return std::nullopt;
    const size_t dash = header.find('-');
    if (dash == std::string::npos) return std::nullopt;
    const std::string from = header.substr(unit.size(), dash - unit.size()), to = header.substr(dash + 1);
    const auto first = parse<uint64_t>(from), last = parse<uint64_t>(to);
    if (from.empty() && last) {  // the last so many bytes
        if (*last == 0) return ByteRange{bytes, bytes};
        return ByteRange{bytes - std::min(bytes, *last), bytes - 1};
    }
    if (!first || (!last && !to.empty()) || (last && *last < *first)) return std::nullopt;
    return ByteRange{*first, std::min(last.value_or(bytes - 1), bytes - 1)};
}

bool matches(const std::string& header, const std::string& etag) {
    return header == "*" || header.find(etag) != std::string::npos;
}

}  // namespace

std::optional<std::string> HttpRequest::queried(const std::string& name) const {
    const auto at = query.find(name);
    return at == query.end() ? std::nullopt : std::optional(at->second);
}

uint64_t HttpRequest::queriedInteger(const std::string& name, uint64_t least, uint64_t most,
                                     std::optional<uint64_t> otherwise) const {
    return queriedAs<uint64_t>(*this, name, least, most, otherwise);
}

double HttpRequest::queriedNumber(const std::string& name, double least, double most,
                                  std::optional<double> otherwise) const {
    return queriedAs<double>(*this, name, least, most, otherwise);
}

bool HttpRequest::queriedFlag(const std::string& name) const {
    const auto text = queried(name);
    if (text && *text != "0" && *text != "1") badQuery(name, "must be 0 or 1");
    return text == "1";
}

void HttpRequest::readBody(uint64_t mostBytes, const Consumer& consumer) {
    const auto refuse = [&] {
        throw Error(ErrorCode::tooLarge, "the body exceeds " + std::to_string(mostBytes) + " bytes");
    };
    if (contentLength.value_or(0) > mostBytes) refuse();
    uint64_t received = 0;
    stream([&](std::span<const std::byte> bytes) {
        received += bytes.size();
        if (received > mostBytes) refuse();
        consumer(bytes);
    });
}

std::string HttpRequest::body(uint64_t mostBytes) {
    std::string text;
    readBody(mostBytes, [&](std::span<const std::byte> bytes) {
        text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    return text;
}

HttpResponse jsonResponse(int status, std::string json) {
    HttpResponse response;
    response.status = status;
    response.body = std::move(json);
    return response;
}

HttpResponse emptyResponse(int status) {
    HttpResponse response;
    response.status = status;
    response.type.clear();
    return response;
}

HttpResponse contentResponse(const HttpRequest& request, std::string type, const std::string& sha256,
                             HttpResponse::Content content) {
    HttpResponse response;
    const std::string etag = '"' + sha256 + '"';
    response.headers = {{"ETag", etag}, {"Accept-Ranges", "bytes"}, {"Cache-Control", "no-cache"}};
    response.type = std::move(type);
    if (const std::string known = request.header("If-None-Match"); !known.empty() && matches(known, etag)) {
        response.status = 304;
        response.type.clear();
        return response;
    }
    const std::string ifRange = request.header("If-Range");
    const auto range = ifRange.empty() || ifRange == etag ? parseRange(request.header("Range"), content.bytes)
                                                          : std::nullopt;
    if (range && range->first >= content.bytes) {
        response.status = 416;
        response.type.clear();
        response.headers.emplace("Content-Range", "bytes */" + std::to_string(content.bytes));
        return response;
    }
    if (range) {
        response.status = 206;
        response.headers.emplace("Content-Range", "bytes " + std::to_string(range->first) + "-" +
                                                      std::to_string(range->last) + "/" +
                                                      std::to_string(content.bytes));
        const uint64_t first = range->first;
        content.bytes = range->last - first + 1;
        content.read = [read = std::move(content.read), first](uint64_t offset, std::span<std::byte> into) {
            read(first + offset, into);
        };
    }
    response.body = std::move(content);
    return response;
}

}  // namespace tilefarm
