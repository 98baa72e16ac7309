#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "worker/scene/json_node.h"

namespace tilefarm {

struct GltfFileOptions {
    bool strict = false;  // what every other reader takes though it is no valid glTF is a fault
    size_t levelsUp = 0;  // above its folder that a file's references may lead
};

/// A .gltf or .glb on disk, told apart by its first bytes: the JSON and the binary chunk.
class GltfFile {
public:
    /// Throws Error(invalidArgument) that names the file if it is not readable or not glTF 2.
    explicit GltfFile(const std::filesystem::path& path, GltfFileOptions options = {});

    JsonNode root() const { return json_->root(); }
    JsonDocument& document() const { return *json_; }
    const std::string& name() const { return json_->file(); }
    /// The GLB's binary chunk, which is buffer 0 if that has no uri.
    const std::optional<std::span<const std::byte>>& binaryChunk() const { return binaryChunk_; }
    /// What a uri names: the bytes of a data URI, or those of a file inside the folder of this one, or above
    /// it as far as the options allow.
    std::vector<std::byte> read(const JsonNode& uri) const;
    /// Fails at `uri` if it names no file that is there; a data URI is.
    void requireThere(const JsonNode& uri) const;

private:
    std::filesystem::path fileOf(const JsonNode& uri) const;

    std::filesystem::path path_;
    GltfFileOptions options_;
    std::vector<std::byte> bytes_;
    std::optional<std::span<const std::byte>> binaryChunk_;
    std::unique_ptr<JsonDocument> json_;
};

/// Whole file; throws Error(invalidArgument) that names it.
std::vector<std::byte> readFileBytes(const std::filesystem::path& path);

}  // namespace tilefarm
