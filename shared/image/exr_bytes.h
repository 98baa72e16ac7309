#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>

namespace tilefarm {

inline constexpr uint32_t kExrMagic = 20000630;

/// Bytes of an EXR file from front to back. Every read is checked; one that fails throws
/// std::runtime_error that names what was wanted.
class ExrBytes {
public:
    explicit ExrBytes(std::span<const std::byte> bytes) : rest_(bytes) {}

    std::span<const std::byte> take(size_t size, const char* what) {
        if (size > rest_.size()) throw std::runtime_error(fmt::format("it ends early, within {}", what));
        const auto taken = rest_.first(size);
        rest_ = rest_.subspan(size);
        return taken;
    }
    template <typename T>
    T get(const char* what) {
        T value;
        std::memcpy(&value, take(sizeof value, what).data(), sizeof value);
        return value;
    }
    /// A name that ends with NUL, of at most 255 characters.
    std::string_view name(const char* what) {
        const auto limit = rest_.first(std::min<size_t>(rest_.size(), 256));
        const auto end = std::find(limit.begin(), limit.end(), std::byte{0});
        if (end == limit.end()) throw std::runtime_error(fmt::format("{} does not end", what));
        const auto size = static_cast<size_t>(end - limit.begin());
        const auto* first = reinterpret_cast<const char*>(take(size + 1, what).data());
        return {first, size};
    }
    size_t size() const { return rest_.size(); }

private:
    std::span<const std::byte> rest_;
};

/// Reads one header, calling `visit(name, type, value)` for each attribute. False at the empty header
/// that ends a multi-part file's list.
template <typename Visit>
bool forEachAttribute(ExrBytes& in, Visit&& visit) {
    const auto text = [](std::span<const std::byte> bytes) {
        return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    for (bool any = false;; any = true) {
        const std::string_view name = in.name("an attribute's name");
        if (name.empty()) return any;
        const std::string_view type = in.name("an attribute's type");
        const auto size = in.get<int32_t>("an attribute's size");
        if (size < 0) throw std::runtime_error(fmt::format("its attribute {} has a negative size", name));
        visit(name, type, text(in.take(static_cast<size_t>(size), "an attribute")));
    }
}

}  // namespace tilefarm
