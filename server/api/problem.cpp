#include "server/api/problem.h"

#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

std::string_view titleOf(int status) {
    switch (status) {
        case 400: return "Bad input";
        case 401: return "Authentication needed";
        case 403: return "Not allowed";
        case 404: return "Not found";
        case 405: return "Method not allowed";
        case 408: return "Too slow";
        case 409: return "Conflict with the current state";
        case 410: return "No longer wanted";
        case 413: return "Too large";
        case 414: return "Path too long";
        case 416: return "Range not satisfiable";
        case 422: return "Cannot be processed";
        case 426: return "Version mismatch";
        case 429: return "Too many requests";
        case 431: return "Head too large";
        case 503: return "Try again later";
        case 507: return "Disk space low";
        default: return status < 500 ? "Refused" : "Internal error";
    }
}

// Whether the same request may succeed later without anything changed by the client.
bool retryable(int status) {
    return status == 408 || status == 429 || status == 503 || status == 507 || status == 500;
}

HttpResponse problem(int status, const std::string& detail, const std::vector<Fault>& faults) {
    nlohmann::json json{
        {"type", "about:blank"}, {"title", titleOf(status)},          {"status", status},
        {"detail", detail},      {"errors", nlohmann::json::array()}, {"retryable", retryable(status)}};
    for (const Fault& fault : faults) {
        json["errors"].push_back({{"pointer", fault.pointer}, {"message", fault.message}});
    }
    auto response = jsonResponse(status, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    response.type = "application/problem+json";
    if (status == 401) response.headers.emplace("WWW-Authenticate", "Bearer");
    if (status == 503 || status == 429) response.headers.emplace("Retry-After", "1");
    if (status == 507) response.headers.emplace("Retry-After", "60");
    return response;
}

}  // namespace

HttpResponse problemResponse(const Error& error) {
    return problem(httpStatus(error.code), error.what(), error.faults);
}

HttpResponse problemResponse(int status, const std::string& detail) {
    return problem(status, detail, {});
}

}  // namespace tilefarm
