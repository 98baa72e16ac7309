#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "server/api/http.h"

namespace tilefarm {

struct Services;

/// One row per method and path; server/api/openapi.json describes the same rows (a test compares).
/// HEAD goes where GET goes.
struct Route {
    std::string_view method;
    std::string_view pattern;  // segments in braces are parameters
    HttpResponse (*handle)(Services& services, HttpRequest& request);
    bool open = false;  // needs no token
};

std::span<const Route> routes();

/// The answer to whoever has no right token, and asks for more than is open to all; nothing for others.
/// `path` as it was sent.
std::optional<HttpResponse> refusedWithoutToken(const Services& services, std::string_view path,
                                                std::string_view authorization);

/// Finds the route and runs it; every fault becomes a problem. Nothing is thrown.
HttpResponse dispatch(Services& services, HttpRequest& request);

}  // namespace tilefarm
