#include "shared/gltf/gltf_bytes.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint64_t kGlbHeader = 20;
constexpr uint64_t kLongestJson = uint64_t{256} << 20;  // a scene of millions of nodes

std::string textOf(const GltfBytes& gltf) {
    std::array<std::byte, kGlbHeader> head{};
    gltf.read(0, std::span(head).first(std::min<uint64_t>(gltf.size, kGlbHeader)));
    uint64_t offset = 0, length = gltf.size;
    if (gltf.size >= kGlbHeader && std::memcmp(head.data(), "glTF", 4) == 0) {
        uint32_t chunk;
        std::memcpy(&chunk, &head[12], sizeof chunk);
        offset = kGlbHeader;
        length = std::min<uint64_t>(chunk, gltf.size - kGlbHeader);
    }
    if (length > kLongestJson) throw Error(ErrorCode::invalidArgument, "the glTF's JSON is too long");
    std::string text(length, ' ');
    gltf.read(offset, std::as_writable_bytes(std::span(text)));
    return text;
}

}  // namespace

GltfBytes bytesOfGltf(std::span<const std::byte> bytes) {
    return {bytes.size(), [bytes](uint64_t offset, std::span<std::byte> into) {
                std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
            }};
}

json readGltfJson(const GltfBytes& gltf, const json::parser_callback_t& isWanted) {
    json document = json::parse(textOf(gltf), isWanted, false);
    if (!document.is_object()) throw Error(ErrorCode::invalidArgument, "the scene is no glTF");
    return document;
}

}  // namespace tilefarm
