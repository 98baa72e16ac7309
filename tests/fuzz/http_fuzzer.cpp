// libFuzzer: whatever stands in the headers of a request for immutable bytes, the answer lies within them;
// whatever stands in a query, a number of the range asked for comes out, or an Error.
//
// Lines of the input: how many bytes there are, Range, If-Range, If-None-Match, a number of a query.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "server/api/http.h"
#include "shared/error/error.h"

namespace {

using namespace tilefarm;

void require(bool sound) {
    if (!sound) std::abort();
}

std::array<std::string, 5> linesOf(std::string_view text) {
    std::array<std::string, 5> lines;
    for (std::string& line : lines) {
        const size_t end = std::min(text.find('\n'), text.size());
        line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

void requireWithin(const HttpResponse& response, uint64_t bytes) {
    if (response.status == 304 || response.status == 416)
        return require(std::get<std::string>(response.body).empty());
    const auto& content = std::get<HttpResponse::Content>(response.body);
    require(response.status == 206 ? content.bytes > 0 && content.bytes <= bytes
                                   : response.status == 200 && content.bytes == bytes);
    if (content.bytes == 0) return;
    std::array<std::byte, 1> one;
    content.read(0, one);
    content.read(content.bytes - 1, one);
}

void askFor(const std::array<std::string, 5>& lines) {
    const uint64_t bytes = std::strtoull(lines[0].c_str(), nullptr, 10);
    HttpRequest request;
    request.header = [&](const std::string& name) {
        return name == "Range"           ? lines[1]
               : name == "If-Range"      ? lines[2]
               : name == "If-None-Match" ? lines[3]
                                         : std::string();
    };
    HttpResponse::Content content{bytes, [&](uint64_t offset, std::span<std::byte> into) {
                                      require(offset < bytes && into.size() <= bytes - offset);
                                  }};
    requireWithin(contentResponse(request, "image/png", "digest", std::move(content)), bytes);
}

template <typename Read>
void readOrRefuse(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        require(error.code == ErrorCode::invalidArgument);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto lines = linesOf({reinterpret_cast<const char*>(data), size});
    askFor(lines);
    HttpRequest request;
    request.query["n"] = lines[4];
    readOrRefuse([&] {
        const uint64_t n = request.queriedInteger("n", 3, 1000);
        require(n >= 3 && n <= 1000);
    });
    readOrRefuse([&] {
        const double x = request.queriedNumber("n", -1, 1);
        require(x >= -1 && x <= 1);
    });
    readOrRefuse([&] { request.queriedFlag("n"); });
    return 0;
}
