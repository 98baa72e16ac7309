#include "shared/job/safe_path.h"

#include <algorithm>
#include <cctype>

namespace tilefarm {

namespace {

constexpr size_t kLongestPath = 1024;
constexpr size_t kLongestSegment = 255;

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

std::string segmentFault(std::string_view segment) {
    if (segment.empty()) return "has an empty segment";
    if (segment == "." || segment == "..") return "must not have the segment '" + std::string(segment) + "'";
    if (segment.size() > kLongestSegment) return "has a segment of more than 255 bytes";
    return {};
}

}  // namespace

std::string pathFault(std::string_view path) {
    if (path.empty()) return "is an empty path";
    if (path.size() > kLongestPath) return "is a path of more than 1024 bytes";
    if (path.front() == '/') return "is an absolute path";
    if (path.size() > 1 && path[1] == ':' && std::isalpha(static_cast<unsigned char>(path[0])))
        return "is an absolute path (a drive letter)";
    for (const char c : path) {
        if (c == '\\') return "has a backslash; folders are split by '/'";
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return "has a control character";
    }
    while (true) {
        const size_t slash = path.find('/');
        if (std::string fault = segmentFault(path.substr(0, slash)); !fault.empty()) return fault;
        if (slash == std::string_view::npos) return {};
        path.remove_prefix(slash + 1);
    }
}

bool hasSuffix(std::string_view path, std::string_view suffix) {
    return path.size() >= suffix.size() &&
           std::equal(suffix.begin(), suffix.end(), path.end() - static_cast<std::ptrdiff_t>(suffix.size()),
                      [](char a, char b) { return lower(a) == lower(b); });
}

}  // namespace tilefarm
