#pragma once

#include <string>
#include <vector>

namespace tilefarm {

/// A list of one-line texts as one column: a line each; line breaks within a text become spaces.
inline std::string joinLines(const std::vector<std::string>& lines) {
    std::string joined;
    for (const std::string& line : lines) {
        for (const char c : line) joined += c == '\n' ? ' ' : c;
        joined += '\n';
    }
    return joined;
}

inline std::vector<std::string> splitLines(const std::string& joined) {
    std::vector<std::string> lines;
    size_t from = 0;
    for (size_t end; (end = joined.find('\n', from)) != std::string::npos; from = end + 1) {
        lines.push_back(joined.substr(from, end - from));
    }
    return lines;
}

}  // namespace tilefarm
