#include "tests/fuzz/gltf_container.h"

#include <array>
#include <cstring>
#include <string>

namespace tilefarm::fuzz {
namespace {

using Bytes = std::vector<std::byte>;

constexpr uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
constexpr std::string_view kDataUri = "data:application/octet-stream;base64,";

uint32_t wordAt(std::span<const std::byte> bytes, size_t at) {
    uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
}

void put(Bytes& out, uint32_t word) {
    const auto bytes = std::as_bytes(std::span(&word, 1));
    out.insert(out.end(), bytes.begin(), bytes.end());
}

void putChunk(Bytes& out, uint32_t type, std::span<const std::byte> data, std::byte padding) {
    const size_t padded = (data.size() + 3) / 4 * 4;
    put(out, static_cast<uint32_t>(padded));
    put(out, type);
    out.insert(out.end(), data.begin(), data.end());
    out.resize(out.size() + padded - data.size(), padding);
}

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string base64(const Bytes& bytes) {
    std::string text;
    uint32_t bits = 0;
    int count = 0;
    for (const std::byte byte : bytes) {
        bits = bits << 8 | std::to_integer<uint32_t>(byte);
        for (count += 8; count >= 6; count -= 6) text += kAlphabet[bits >> (count - 6) & 63];
    }
    if (count > 0) text += kAlphabet[bits << (6 - count) & 63];
    text.resize((text.size() + 3) / 4 * 4, '=');
    return text;
}

Bytes fromBase64(std::string_view text) {
    static const auto values = [] {
        std::array<int, 256> table{};
        table.fill(-1);
        for (size_t i = 0; i < kAlphabet.size(); ++i)
            table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<int>(i);
        return table;
    }();
    Bytes bytes;
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) break;
        bits = bits << 6 | static_cast<uint32_t>(value);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::byte>(bits >> count & 0xff));
    }
    return bytes;
}

// Buffer 0, if it is there.
Json* bufferOf(Json& document) {
    const auto buffers = document.find("buffers");
    if (buffers == document.end() || !buffers->is_array() || buffers->empty()) return nullptr;
    return buffers->front().is_object() ? &buffers->front() : nullptr;
}

std::string_view dataOf(const Json& buffer) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) return {};
    const std::string_view text = uri->get_ref<const std::string&>();
    const size_t comma = text.find(";base64,");
    return text.starts_with("data:") && comma != text.npos ? text.substr(comma + 8) : std::string_view{};
}

}  // namespace

std::optional<GltfContainer> GltfContainer::parse(std::span<const std::byte> bytes) {
    GltfContainer result;
    std::span<const std::byte> text = bytes;
    if (bytes.size() >= 20 && wordAt(bytes, 0) == kMagic) {
        result.glb = true;
        text = bytes.subspan(20, std::min<size_t>(bytes.size() - 20, wordAt(bytes, 12)));
        const size_t next = 20 + text.size();
        if (bytes.size() - next >= 8) {
            const size_t length = std::min<size_t>(bytes.size() - next - 8, wordAt(bytes, next));
            const auto data = bytes.subspan(next + 8, length);
            result.binary.emplace(data.begin(), data.end());
        }
    }
    const auto* first = reinterpret_cast<const char*>(text.data());
    result.json = Json::parse(first, first + text.size(), nullptr, false);
    if (!result.json.is_object()) return std::nullopt;
    return result;
}

Bytes GltfContainer::bytes() const {
    const std::string text = textOf(json);
    const auto characters = std::as_bytes(std::span(text));
    if (!glb) return {characters.begin(), characters.end()};
    Bytes out;
    put(out, kMagic);
    put(out, 2);
    put(out, 0);
    putChunk(out, kJson, characters, std::byte{' '});
    if (binary) putChunk(out, kBinary, *binary, std::byte{0});
    const auto size = static_cast<uint32_t>(out.size());
    std::memcpy(out.data() + 8, &size, sizeof size);
    return out;
}

Bytes GltfContainer::buffer() const {
    if (binary) return *binary;
    auto copy = json.find("buffers");
    if (copy == json.end() || !copy->is_array() || copy->empty() || !copy->front().is_object()) return {};
    return fromBase64(dataOf(copy->front()));
}

void GltfContainer::setBuffer(const Bytes& bytes) {
    Json* const node = bufferOf(json);
    if (binary) {
        binary = bytes;
    } else if (node) {
        (*node)["uri"] = std::string(kDataUri) + base64(bytes);
    }
    if (node) (*node)["byteLength"] = bytes.size();
}

void GltfContainer::turnIntoOther() {
    const Bytes bytes = buffer();
    Json* const node = bufferOf(json);
    glb = !glb;
    if (glb) {
        if (!node || dataOf(*node).empty()) return;
        node->erase("uri");
        binary = bytes;
    } else if (binary) {
        binary.reset();
        setBuffer(bytes);
    }
}

}  // namespace tilefarm::fuzz
