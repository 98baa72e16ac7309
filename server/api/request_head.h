#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tilefarm {

/// The first line and the headers of a request as RFC 9112 has them, before anything is decoded.
struct RequestHead {
    std::string method, target;
    std::vector<std::pair<std::string, std::string>> headers;  // names in lower case

    /// Of the first header of that name, which is in lower case; "" if there is none.
    std::string_view header(std::string_view name) const;
    size_t count(std::string_view name) const;
    /// The target without its query.
    std::string_view path() const;
};

inline constexpr size_t kMostHeaders = 100;

/// Where the body begins; npos while the head is not whole.
size_t endOfHead(std::string_view received);

/// Throws Error(invalidArgument) that says what is wrong, above all whatever two readers could take for
/// different requests: two lengths, a length and a transfer coding, a coding other than chunked, blanks in
/// front of a colon, a line that goes on in the next.
RequestHead parseHead(std::string_view head);

}  // namespace tilefarm
