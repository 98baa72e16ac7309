#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>

namespace tilefarm {

/// Reads `into.size()` bytes from `offset` of a .gltf or .glb of `size` bytes.
struct GltfBytes {
    uint64_t size = 0;
    std::function<void(uint64_t offset, std::span<std::byte> into)> read;
};

/// Bytes in memory, which must outlive what is given.
GltfBytes bytesOfGltf(std::span<const std::byte> bytes);

/// The JSON of a glTF file, as much of it as `isWanted` keeps. Throws Error(invalidArgument) if that is no
/// object. For those who ask a question or two of a file; the loader (worker/scene) checks all of it.
nlohmann::json readGltfJson(const GltfBytes& gltf,
                            const nlohmann::json::parser_callback_t& isWanted = nullptr);

}  // namespace tilefarm
