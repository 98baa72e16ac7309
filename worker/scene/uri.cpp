#include "worker/scene/uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

namespace tilefarm {
namespace {

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percentDecode(std::string_view text, const JsonNode& node) {
    std::string decoded;
    decoded.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
        const int low = high >= 0 ? hexDigit(text[i + 2]) : -1;
        if (low < 0) {
            node.fail(fmt::format("has a % at character {} that two hexadecimal digits do not follow", i));
        }
        decoded += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return decoded;
}

constexpr auto kBase64Values = [] {
    std::array<int8_t, 256> values{};
    values.fill(-1);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < alphabet.size(); ++i) {
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<int8_t>(i);
    }
    return values;
}();

/// MIME wraps base64 by lines, and so do some writers of data URIs.
std::string withoutBlanks(std::string_view text, const JsonNode& node) {
    constexpr std::string_view blanks = " \t\r\n";
    std::string kept(text);
    std::erase_if(kept, [blanks](char c) { return blanks.find(c) != std::string_view::npos; });
    if (kept.size() != text.size()) {
        node.tolerate("its base64 data has blanks or line breaks", "read without them");
    }
    return kept;
}

bool sameWord(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::vector<std::byte> decodeBase64(std::string_view given, const JsonNode& node) {
    const std::string kept = withoutBlanks(given, node);
    std::string_view text = kept;
    while (!text.empty() && text.back() == '=') {
        text.remove_suffix(1);
    }
    if (text.size() % 4 == 1) {
        node.fail("its base64 data is cut short");
    }
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    uint32_t bits = 0;
    int count = 0;
    for (char c : text) {
        const int value = kBase64Values[static_cast<unsigned char>(c)];
        if (value < 0) {
            node.fail("its base64 data has a character that is not base64");
        }
        bits = bits << 6 | static_cast<uint32_t>(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(static_cast<std::byte>(bits >> count & 0xff));
        }
    }
    return bytes;
}

bool hasScheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    const size_t slash = uri.find('/');
    return colon != std::string_view::npos && colon < slash && colon > 0 &&
           std::all_of(uri.begin(), uri.begin() + static_cast<ptrdiff_t>(colon),
                       [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

}  // namespace

bool isDataUri(std::string_view uri) {
    return sameWord(uri.substr(0, 5), "data:");
}

std::vector<std::byte> decodeDataUri(std::string_view uri, const JsonNode& node) {
    const size_t comma = uri.find(',');
    if (comma == std::string_view::npos) {
        node.fail("is a data URI without data");
    }
    const std::string_view header = uri.substr(5, comma - 5);
    const std::string_view data = uri.substr(comma + 1);
    constexpr std::string_view base64 = ";base64";
    const std::string_view end = header.substr(header.size() - std::min(header.size(), base64.size()));
    if (!uri.starts_with("data:") || (end != base64 && sameWord(end, base64))) {
        node.tolerate("does not begin with \"data:\" and name \"base64\" in small letters",
                      "read as if it did");
    }
    if (sameWord(end, base64)) {
        // Some writers percent-encode the padding.
        return data.find('%') == std::string_view::npos ? decodeBase64(data, node)
                                                        : decodeBase64(percentDecode(data, node), node);
    }
    const std::string text = percentDecode(data, node);
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

TidyPath relativePathOf(const JsonNode& uri, size_t levelsUp) {
    const std::string& text = uri.text();
    if (text.empty()) {
        uri.fail("is empty");
    }
    if (hasScheme(text)) {
        uri.fail("must be a data URI or a file beside the scene; nothing is fetched");
    }
    const std::string decoded = percentDecode(text, uri);
    if (decoded.find('\0') != std::string::npos || decoded.find('\\') != std::string::npos) {
        uri.fail("must not have zero bytes or backslashes");
    }
    const TidyPath path = tidyPath(decoded);
    if (const std::string fault = referenceFault(path); !fault.empty()) {
        uri.fail(fmt::format("names \"{}\", which {}", decoded, fault));
    }
    if (path.levelsUp > levelsUp) {
        uri.fail(fmt::format("must name a file inside the scene's bundle, names \"{}\"", decoded));
    }
    return path;
}

}  // namespace tilefarm
