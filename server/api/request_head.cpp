#include "server/api/request_head.h"

#include <algorithm>
#include <utility>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorCode::invalidArgument, "the request cannot be read: " + why);
}

bool isTokenCharacter(char c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return letter || std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool isToken(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), isTokenCharacter);
}

bool hasControls(std::string_view text) {
    return std::any_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < ' ' && c != '\t') || byte == 127;
    });
}

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

std::string_view trimmed(std::string_view text) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    return text;
}

void readRequestLine(std::string_view line, RequestHead& head) {
    const size_t first = line.find(' '), last = line.rfind(' ');
    if (first == std::string_view::npos || last == first) refuse("its first line has no three words");
    const std::string_view target = line.substr(first + 1, last - first - 1), version = line.substr(last + 1);
    head.method = line.substr(0, first);
    head.target = target;
    const bool isTarget = !target.empty() && (target.front() == '/' || target == "*") &&
                          target.find(' ') == std::string_view::npos && !hasControls(target);
    if (!isToken(head.method) || !isTarget || (version != "HTTP/1.1" && version != "HTTP/1.0"))
        refuse("its first line is not METHOD /path HTTP/1.1");
}

void readHeader(std::string_view line, RequestHead& head) {
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos || !isToken(line.substr(0, colon)))
        refuse("a header is not NAME: VALUE");
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (hasControls(value)) refuse("a header holds a control character");
    if (head.headers.size() == kMostHeaders) refuse("more than 100 headers");
    head.headers.emplace_back(lower(line.substr(0, colon)), value);
}

void requireOneLength(const RequestHead& head) {
    const size_t lengths = head.count("content-length"), codings = head.count("transfer-encoding");
    if (lengths + codings > 1) refuse("more than one Content-Length or Transfer-Encoding");
    const std::string_view length = head.header("content-length");
    const bool isNumber = !length.empty() && length.size() <= 18 &&
                          length.find_first_not_of("0123456789") == std::string_view::npos;
    if (lengths == 1 && !isNumber) refuse("Content-Length is no whole number");
    if (codings == 1 && lower(head.header("transfer-encoding")) != "chunked")
        refuse("Transfer-Encoding is not chunked");
}

}  // namespace

std::string_view RequestHead::header(std::string_view name) const {
    const auto at =
        std::find_if(headers.begin(), headers.end(), [&](const auto& h) { return h.first == name; });
    return at == headers.end() ? std::string_view{} : std::string_view(at->second);
}

size_t RequestHead::count(std::string_view name) const {
    return static_cast<size_t>(
        std::count_if(headers.begin(), headers.end(), [&](const auto& h) { return h.first == name; }));
}

std::string_view RequestHead::path() const {
    return std::string_view(target).substr(0, target.find('?'));
}

size_t endOfHead(std::string_view received) {
    const size_t at = received.find("\r\n\r\n");
    return at == std::string_view::npos ? at : at + 4;
}

RequestHead parseHead(std::string_view text) {
    RequestHead head;
    bool first = true;
    while (text.size() > 2) {  // an empty line ends it
        const size_t end = text.find("\r\n");
        const std::string_view line = text.substr(0, end);
        if (line.empty()) break;
        std::exchange(first, false) ? readRequestLine(line, head) : readHeader(line, head);
        text.remove_prefix(end + 2);
    }
    if (first) refuse("it is empty");
    requireOneLength(head);
    return head;
}

}  // namespace tilefarm
