#pragma once

#include <string>
#include <string_view>

#include "shared/error/error.h"

namespace tilefarm {

/// What a status that is no success means to a client; the server's table turned round. Statuses that
/// a proxy in between makes up (502, 504) are unavailable, what no one expects is internal.
ErrorCode errorCodeOf(int status);

/// The Error of an answer: its problem+json gives message and faults (RFC 9457), else `request` and
/// the status make one.
Error errorOfAnswer(int status, std::string_view body, const std::string& request);

/// A path segment or query value with all but unreserved characters percent-encoded (RFC 3986).
std::string percentEncoded(std::string_view text);

/// "sha-256=:<base64>:" of 64 hex digits, as Content-Digest has it (RFC 9530).
std::string contentDigest(std::string_view sha256Hex);

}  // namespace tilefarm
