#include "shared/farm_client/http_status.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace tilefarm {

namespace {

using nlohmann::json;

struct StatusMeaning {
    int status;
    ErrorCode code;
};
constexpr std::array kMeanings{
    StatusMeaning{400, ErrorCode::invalidArgument},
    StatusMeaning{401, ErrorCode::unauthorized},
    StatusMeaning{403, ErrorCode::forbidden},
    StatusMeaning{404, ErrorCode::notFound},
    StatusMeaning{408, ErrorCode::unavailable},
    StatusMeaning{409, ErrorCode::conflict},
    StatusMeaning{410, ErrorCode::gone},
    StatusMeaning{413, ErrorCode::tooLarge},
    StatusMeaning{414, ErrorCode::tooLarge},
    StatusMeaning{422, ErrorCode::unprocessable},
    StatusMeaning{426, ErrorCode::versionRefused},
    StatusMeaning{429, ErrorCode::tooMany},
    StatusMeaning{500, ErrorCode::internal},
    StatusMeaning{502, ErrorCode::unavailable},
    StatusMeaning{503, ErrorCode::unavailable},
    StatusMeaning{504, ErrorCode::unavailable},
    StatusMeaning{507, ErrorCode::outOfSpace},
};

// A string member or nothing; an answer is not to be trusted to be well formed.
std::string textOf(const json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::vector<Fault> faultsOf(const json& problem) {
    std::vector<Fault> faults;
    if (const auto list = problem.find("errors"); list != problem.end() && list->is_array())
        for (const json& entry : *list)
            if (entry.is_object()) faults.push_back({textOf(entry, "pointer"), textOf(entry, "message")});
    return faults;
}

std::array<uint8_t, 32> bytesOfHex(std::string_view hex) {
    const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
    std::array<uint8_t, 32> bytes{};
    for (size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<uint8_t>(digit(hex.at(2 * i)) * 16 + digit(hex.at(2 * i + 1)));
    return bytes;
}

}  // namespace

ErrorCode errorCodeOf(int status) {
    for (const StatusMeaning& m : kMeanings)
        if (m.status == status) return m.code;
    return ErrorCode::internal;
}

Error errorOfAnswer(int status, std::string_view body, const std::string& request) {
    const json problem = json::parse(body, nullptr, false);
    if (!problem.is_object())
        return {errorCodeOf(status), fmt::format("the server answered {} with status {}", request, status)};
    std::string message = textOf(problem, "detail");
    if (message.empty()) message = textOf(problem, "title");
    if (message.empty()) message = fmt::format("the server answered {} with status {}", request, status);
    return {errorCodeOf(status), message, faultsOf(problem)};
}

std::string percentEncoded(std::string_view text) {
    std::string encoded;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80 && (std::isalnum(byte) || std::string_view("-._~").find(c) != std::string_view::npos))
            encoded += c;
        else
            encoded += fmt::format("%{:02X}", byte);
    }
    return encoded;
}

std::string contentDigest(std::string_view sha256Hex) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::array<uint8_t, 32> bytes = bytesOfHex(sha256Hex);
    std::string base64;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](size_t k) { return k < bytes.size() ? uint32_t{bytes[k]} : 0u; };
        const uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        for (int shift = 18; shift >= 0; shift -= 6) base64 += alphabet[group >> shift & 63];
    }
    base64.back() = '=';  // 32 bytes are ten groups and two bytes
    return "sha-256=:" + base64 + ":";
}

}  // namespace tilefarm
