#include "worker/cache_file/cache_file.h"

#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <fstream>

namespace tilefarm {
namespace {

constexpr uint64_t kFnvBasis = 0xcbf29ce484222325u, kFnvPrime = 0x100000001b3u;

uint64_t fnv1a(std::span<const std::byte> bytes) {
    uint64_t hash = kFnvBasis;
    for (std::byte byte : bytes) hash = (hash ^ static_cast<uint8_t>(byte)) * kFnvPrime;
    return hash;
}

std::filesystem::path partOf(const std::filesystem::path& path) {
    static std::atomic<uint32_t> parts{0};
    return path.string() + fmt::format(".{}-{}.part", getpid(), ++parts);
}

}  // namespace

std::vector<std::byte> readCacheFile(const std::filesystem::path& path) {
    std::error_code failed;
    const uint64_t size = std::filesystem::file_size(path, failed);
    uint64_t checksum = 0;
    if (failed || size < sizeof checksum) return {};
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> bytes(size - sizeof checksum);
    file.read(reinterpret_cast<char*>(&checksum), sizeof checksum);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return file && fnv1a(bytes) == checksum ? bytes : std::vector<std::byte>{};
}

void writeCacheFile(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    const auto part = partOf(path);
    const uint64_t checksum = fnv1a(bytes);
    std::ofstream file(part, std::ios::binary);
    file.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code ignored;
    if (file)
        std::filesystem::rename(part, path, ignored);
    else
        std::filesystem::remove(part, ignored);
}

}  // namespace tilefarm
