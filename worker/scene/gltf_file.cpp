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
    std::string departure;  // from the format, which other readers do not mind
};

/// The chunk at `offset` with its header.
std::span<const std::byte> chunkAt(std::span<const std::byte> bytes, size_t offset, int number,
                                   const std::filesystem::path& path) {
    const uint32_t length = readU32(bytes, offset);
    const size_t left = bytes.size() - offset - 8;
    if (length > left) {
        failFile(path, fmt::format("GLB chunk {} says {} bytes, but {} are left", number, length, left));
    }
    return bytes.subspan(offset, size_t{length} + 8);
}

/// The chunks of a GLB: 12 bytes of header, then (length, type, data) each. The JSON comes first, then the
/// binary chunk; what follows, and what lies behind the length in the header, is none of ours.
GlbChunks splitGlb(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    if (bytes.size() < 20) {
        failFile(path, "the GLB is cut short: its header is not whole");
    }
    if (const uint32_t version = readU32(bytes, 4); version != 2) {
        failFile(path, fmt::format("is GLB version {}, only version 2 is known", version));
    }
    uint64_t end = readU32(bytes, 8);
    if (end > bytes.size()) {
        failFile(path, fmt::format("the GLB is cut short: it says {} bytes, has {}", end, bytes.size()));
    }
    const auto json = chunkAt(bytes, 12, 0, path);
    if (readU32(json, 4) != kJsonChunk) {
        failFile(path, "the GLB's first chunk is not JSON");
    }
    GlbChunks chunks{json.subspan(8), std::nullopt, {}};
    if (end < bytes.size()) {
        chunks.departure = fmt::format("its header says {} bytes, has {}", end, bytes.size());
    }
    const size_t next = 12 + json.size();
    if (end < next) {
        end = bytes.size();  // no length at all: the chunks say where they end
    }
    if (next + 8 <= end && readU32(bytes, next + 4) == kBinaryChunk) {
        chunks.binary = chunkAt(bytes, next, 1, path).subspan(8);
    }
    return chunks;
}

/// Some writers fill the chunk up with zeros where it should be spaces.
std::string_view withoutZeros(std::string_view text) {
    return text.substr(0, text.find_last_not_of('\0') + 1);
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

GltfFile::GltfFile(const std::filesystem::path& path, GltfFileOptions options)
    : path_(path), options_(options), bytes_(readFileBytes(path)) {
    std::span<const std::byte> text = bytes_;
    const bool binary = bytes_.size() >= 4 && readU32(bytes_, 0) == kGlbMagic;
    GlbChunks chunks;
    if (binary) {
        chunks = splitGlb(bytes_, path);
        text = chunks.json;
        binaryChunk_ = chunks.binary;
    }
    const std::string_view json = binary ? withoutZeros(asText(text)) : asText(text);
    json_ = std::make_unique<JsonDocument>(json, path.string(), options.strict);
    checkVersion(root());
    if (!chunks.departure.empty()) {
        root().tolerate(chunks.departure, "the bytes behind are left out");
    }
    if (json.size() != text.size()) {
        root().tolerate("its JSON is filled up with zeros", "read without them");
    }
    if (!binary) {
        bytes_ = {};
    }
}

std::filesystem::path GltfFile::fileOf(const JsonNode& uri) const {
    const TidyPath path = relativePathOf(uri, options_.levelsUp);
    return BundleRoot(path_, path.levelsUp).fileOf(path);
}

void GltfFile::requireThere(const JsonNode& uri) const {
    std::error_code fault;
    if (!isDataUri(uri.text()) && !std::filesystem::is_regular_file(fileOf(uri), fault)) {
        uri.fail(fmt::format("names \"{}\", which is not there", uri.text()));
    }
}

std::vector<std::byte> GltfFile::read(const JsonNode& uri) const {
    if (isDataUri(uri.text())) {
        return decodeDataUri(uri.text(), uri);
    }
    try {
        return readFileBytes(fileOf(uri));
    } catch (const Error& fault) {
        if (!fault.faults.empty()) {
            throw;  // names its place already
        }
        uri.fail(fault.what());
    }
}

}  // namespace tilefarm
