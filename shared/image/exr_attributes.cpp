#include "shared/image/exr_attributes.h"

#include <fmt/format.h>

namespace tilefarm {
namespace {

std::string partName(const std::string& name, size_t number) {
    return fmt::format("{}.{:03}", name, number);
}

// The longest start of a text that fits and does not cut a character of UTF-8 in two.
size_t startOf(std::string_view text) {
    if (text.size() <= kMostAttributeBytes) return text.size();
    size_t size = kMostAttributeBytes;
    for (size_t i = 0; i < 4; ++i)
        if ((static_cast<unsigned char>(text[size - i]) & 0xc0) != 0x80) return size - i;
    return size;  // no UTF-8
}

constexpr std::string_view kFirstSuffix = ".001";

}  // namespace

std::map<std::string, std::string> splitAttribute(const std::string& name, std::string_view text) {
    if (text.size() <= kMostAttributeBytes) return {{name, std::string(text)}};
    std::map<std::string, std::string> parts;
    for (size_t number = 1; !text.empty(); ++number) {
        const size_t size = startOf(text);
        parts[partName(name, number)] = text.substr(0, size);
        text.remove_prefix(size);
    }
    return parts;
}

ImageAttributes joinAttributes(const ImageAttributes& entries) {
    ImageAttributes joined = entries;
    for (const auto& [first, text] : entries) {
        if (!first.ends_with(kFirstSuffix)) continue;
        const std::string name = first.substr(0, first.size() - kFirstSuffix.size());
        if (entries.contains(name)) continue;
        std::string& whole = joined[name];
        for (size_t number = 1;; ++number) {
            const auto part = joined.extract(partName(name, number));
            if (part.empty()) break;
            whole += part.mapped();
        }
    }
    return joined;
}

}  // namespace tilefarm
