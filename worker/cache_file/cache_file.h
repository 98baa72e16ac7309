#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace tilefarm {

// Files whose loss costs time and nothing else: they are not synced to the disk, and what cannot be read or
// written is no error.

/// What writeCacheFile was given; empty if the file is missing, torn or altered.
std::vector<std::byte> readCacheFile(const std::filesystem::path& path);

/// Replaces the file, with a checksum before the bytes, in one step: processes that share the folder never
/// read half a file. The folder must exist.
void writeCacheFile(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace tilefarm
