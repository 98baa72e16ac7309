#include "shared/image/exr_header_check.h"

#include <array>

#include "shared/image/exr_bytes.h"

namespace tilefarm {
namespace {

constexpr uint64_t kLargestFreeTile = uint64_t{4096} * 4096;  // pixels of a tile that no bytes need bear out

// OpenEXR reads these by their type, whatever size stands before them: with another one, it would go on from
// another place than we do.
constexpr std::array<std::pair<std::string_view, size_t>, 24> kFixedSizes{{
    {"box2f", 16},
    {"box2i", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33d", 72},
    {"m33f", 36},
    {"m44d", 128},
    {"m44f", 64},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2d", 16},
    {"v2f", 8},
    {"v2i", 8},
    {"v3d", 24},
    {"v3f", 12},
    {"v3i", 12},
}};

std::span<const std::byte> bytesOf(std::string_view value) {
    return std::as_bytes(std::span(value));
}

// The end of a list of channels is an empty name, which must be the attribute's last byte.
void requireChannelList(std::string_view value) {
    ExrBytes in(bytesOf(value));
    while (!in.name("a channel's name").empty()) in.take(16, "a channel");
    if (in.size() != 0) throw std::runtime_error("its list of channels ends before the attribute does");
}

void requirePreview(std::string_view value) {
    ExrBytes in(bytesOf(value));
    const auto width = in.get<uint32_t>("the preview's size"),
               height = in.get<uint32_t>("the preview's size");
    if (width > 0xffff || height > 0xffff || in.size() != uint64_t{4} * width * height)
        throw std::runtime_error("its preview has another size than it says");
}

void requireStringVector(std::string_view value) {
    ExrBytes in(bytesOf(value));
    while (in.size() != 0) {
        const auto length = in.get<int32_t>("a string's length");
        if (length < 0) throw std::runtime_error("a string has a negative length");
        in.take(static_cast<size_t>(length), "a string");
    }
}

void requireType(std::string_view name, std::string_view type, std::string_view value) {
    const auto known =
        std::find_if(kFixedSizes.begin(), kFixedSizes.end(), [&](const auto& t) { return t.first == type; });
    if (known != kFixedSizes.end() && value.size() != known->second)
        throw std::runtime_error(fmt::format("its attribute {} of type {} has {} bytes, not {}", name, type,
                                             value.size(), known->second));
    if (type == "chlist") requireChannelList(value);
    if (type == "preview") requirePreview(value);
    if (type == "stringvector") requireStringVector(value);
}

// OpenEXR also makes tables of a window's height and buffers of a tile's size as soon as it opens a file.
void requireSizes(std::string_view name, std::string_view value, uint64_t encodedBytes) {
    if (name == "dataWindow" && value.size() == 4 * sizeof(int32_t)) {
        std::array<int32_t, 4> window;
        std::memcpy(window.data(), value.data(), value.size());
        const int64_t w = int64_t{window[2]} - window[0] + 1, h = int64_t{window[3]} - window[1] + 1;
        if (w > kLargestExrSide || h > kLargestExrSide)
            throw std::runtime_error(
                fmt::format("it claims {}x{} pixels; {} a side are the most", w, h, kLargestExrSide));
    }
    if (name == "tiles" && value.size() == 2 * sizeof(uint32_t) + 1) {
        std::array<uint32_t, 2> tile;
        std::memcpy(tile.data(), value.data(), sizeof tile);
        const uint64_t pixels = uint64_t{tile[0]} * tile[1];
        // Tiles may be larger than a small picture.
        if (pixels > kLargestFreeTile && pixels / (kMostExrExpansion / sizeof(float)) > encodedBytes)
            throw std::runtime_error(
                fmt::format("{} bytes cannot hold its tiles of {}x{}", encodedBytes, tile[0], tile[1]));
    }
}

}  // namespace

size_t requireHonestExrHeaders(std::span<const std::byte> bytes) {
    ExrBytes in(bytes);
    if (bytes.size() < 8 || in.get<uint32_t>("the magic number") != kExrMagic)
        throw std::runtime_error("it is none");
    constexpr uint32_t kMultiPart = 0x1000;
    const bool multiPart = in.get<uint32_t>("the version") & kMultiPart;
    const auto check = [&](auto name, auto type, auto value) {
        requireType(name, type, value);
        requireSizes(name, value, bytes.size());
    };
    size_t parts = 0;
    while (forEachAttribute(in, check)) {
        ++parts;
        if (!multiPart) break;
    }
    return parts;
}

}  // namespace tilefarm
