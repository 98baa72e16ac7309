#pragma once

#include "server/api/http.h"
#include "shared/error/error.h"

namespace tilefarm {

/// The one place where an Error becomes an HTTP status.
constexpr int httpStatus(ErrorCode code) {
    switch (code) {
        case ErrorCode::invalidArgument: return 400;
        case ErrorCode::unauthorized: return 401;
        case ErrorCode::forbidden: return 403;
        case ErrorCode::notFound: return 404;
        case ErrorCode::tooSlow: return 408;
        case ErrorCode::conflict: return 409;
        case ErrorCode::gone: return 410;
        case ErrorCode::tooLarge: return 413;
        case ErrorCode::unprocessable: return 422;
        case ErrorCode::versionRefused: return 426;
        case ErrorCode::tooMany: return 429;
        case ErrorCode::internal: return 500;
        case ErrorCode::unavailable: return 503;
        case ErrorCode::outOfSpace: return 507;
    }
    return 500;
}

/// application/problem+json (RFC 9457).
HttpResponse problemResponse(const Error& error);
HttpResponse problemResponse(int status, const std::string& detail);

}  // namespace tilefarm
