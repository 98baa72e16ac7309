#include "worker/scene/gltf_file.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>

#include "shared/error/error.h"
#include "worker/scene/limits.h"
#include "worker/scene/uri.h"

namespace tilefarm {
namespace {

constexpr uint32_t kGlbMagic = 0x46546C67;     // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;    // "JSON"
constexpr uint32_t kBinaryChunk = 0x004E4942;  // "BIN\0"

[[noreturn]] void failFile(const std::filesystem::path& path, const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}", path.string(), fault));
}

uint32_t readU32(std::span<const std::byte> bytes, size_t offset) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

std::string_view asText(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct GlbChunks {
    std::span<const std::byte> json;
    std::optional<std::span<const std::byte>> binary;
};

/// The chunks of a GLB: 12 bytes of header, then (length, type, data) each. Unknown types are skipped.
GlbChunks splitGlb(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    if (bytes.size() < 20) {
        failFile(path, "the GLB is cut short: its header is not whole");
    }
    if (const uint32_t version = readU32(bytes, 4); version != 2) {
        failFile(path, fmt::format("is GLB version {}, only version 2 is known", version));
    }
    if (const uint32_t length = readU32(bytes, 8); length > bytes.size()) {
        failFile(path, fmt::format("the GLB is cut short: it says {} bytes, has {}", length, bytes.size()));
    }
    GlbChunks chunks;
    size_t offset = 12;
    for (int number = 0; bytes.size() - offset >= 8; ++number) {
        const uint32_t length = readU32(bytes, offset);
        const uint32_t type = readU32(bytes, offset + 4);
        offset += 8;
        if (length > bytes.size() - offset) {
            failFile(path, fmt::format("GLB chunk {} says {} bytes, but {} are left", number, length,
                                       bytes.size() - offset));
        }
        const auto data = bytes.subspan(offset, length);
        if (number == 0 && type != kJsonChunk) {
            failFile(path, "the GLB's first chunk is not JSON");
        }
        if (number == 0) {
            chunks.json = data;
        } else if (number == 1 && type == kBinaryChunk) {
            chunks.binary = data;
        }
        offset += length;
    }
    return chunks;
}

void checkVersion(const JsonNode& root) {
    const JsonNode asset = root["asset"];
    const std::string version = asset["version"].text();
    if (!version.starts_with("2.")) {
        asset["version"].fail(fmt::format("is \"{}\", only glTF 2 is known", version));
    }
    if (const JsonNode least = asset["minVersion"]; least && least.text() != "2.0") {
        least.fail(fmt::format("asks for \"{}\", only glTF 2.0 is known", least.text()));
    }
}

}  // namespace

std::vector<std::byte> readFileBytes(const std::filesystem::path& path) {
    std::error_code fault;
    if (!std::filesystem::is_regular_file(path, fault)) {
        failFile(path,
                 fault || !std::filesystem::exists(path, fault) ? "there is no such file" : "is not a file");
    }
    const uint64_t size = std::filesystem::file_size(path, fault);
    if (fault || size > kMaxFileBytes) {
        failFile(path, fault ? fault.message() : fmt::format("is larger than {} bytes", kMaxFileBytes));
    }
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> bytes(size);
    if (!file || !file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
        failFile(path, "cannot be read");
    }
    return bytes;
}

GltfFile::GltfFile(const std::filesystem::path& path)
    : folder_(path.parent_path()), bytes_(readFileBytes(path)) {
    std::span<const std::byte> text = bytes_;
    const bool binary = bytes_.size() >= 4 && readU32(bytes_, 0) == kGlbMagic;
    if (binary) {
        const GlbChunks chunks = splitGlb(bytes_, path);
        text = chunks.json;
        binaryChunk_ = chunks.binary;
    }
    json_ = std::make_unique<JsonDocument>(asText(text), path.string());
    checkVersion(root());
    if (!binary) {
        bytes_ = {};
    }
}

std::vector<std::byte> GltfFile::read(const JsonNode& uri) const {
    if (isDataUri(uri.text())) {
        return decodeDataUri(uri.text(), uri);
    }
    const auto path = folder_ / relativePathOf(uri);
    try {
        return readFileBytes(path);
    } catch (const Error& fault) {
        uri.fail(fault.what());
    }
}

}  // namespace tilefarm
