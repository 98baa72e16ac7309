#include "tests/support/gltf_builder.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

using nlohmann::json;

void appendU32(std::vector<std::byte>& out, uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
        out.push_back(static_cast<std::byte>(value >> shift & 0xff));
    }
}

void appendBigU32(std::vector<std::byte>& out, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        out.push_back(static_cast<std::byte>(value >> shift & 0xff));
    }
}

uint32_t crc32(std::span<const std::byte> bytes) {
    uint32_t crc = 0xffffffffu;
    for (std::byte byte : bytes) {
        crc ^= std::to_integer<uint32_t>(byte);
        for (int k = 0; k < 8; ++k) {
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
        }
    }
    return ~crc;
}

void appendPngChunk(std::vector<std::byte>& out, const char* type, std::span<const std::byte> data) {
    appendBigU32(out, static_cast<uint32_t>(data.size()));
    std::vector<std::byte> body;
    std::transform(type, type + 4, std::back_inserter(body),
                   [](char c) { return static_cast<std::byte>(c); });
    body.insert(body.end(), data.begin(), data.end());
    out.insert(out.end(), body.begin(), body.end());
    appendBigU32(out, crc32(body));
}

/// Stored blocks: deflate without compression.
std::vector<std::byte> zlibStored(const std::vector<std::byte>& raw) {
    std::vector<std::byte> out{std::byte{0x78}, std::byte{0x01}};
    uint32_t a = 1, b = 0;
    for (std::byte byte : raw) {
        a = (a + std::to_integer<uint32_t>(byte)) % 65521;
        b = (b + a) % 65521;
    }
    for (size_t at = 0; at < raw.size(); at += 65535) {
        const size_t length = std::min<size_t>(65535, raw.size() - at);
        out.push_back(std::byte{at + length == raw.size()});
        const auto n = static_cast<uint32_t>(length);
        for (uint32_t half : {n, ~n}) {
            out.push_back(static_cast<std::byte>(half & 0xff));
            out.push_back(static_cast<std::byte>(half >> 8 & 0xff));
        }
        out.insert(out.end(), raw.begin() + ptrdiff_t(at), raw.begin() + ptrdiff_t(at + length));
    }
    appendBigU32(out, b << 16 | a);
    return out;
}

}  // namespace

GltfBuilder::GltfBuilder() : json_(std::make_unique<json>()) {
    *json_ = json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}],
                             "buffers": [{"byteLength": 0}]})");
}
GltfBuilder::~GltfBuilder() = default;
GltfBuilder::GltfBuilder(GltfBuilder&&) noexcept = default;
GltfBuilder& GltfBuilder::operator=(GltfBuilder&&) noexcept = default;

GltfBuilder GltfBuilder::triangle() {
    GltfBuilder builder;
    const uint32_t positions = builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    builder.set("/meshes/0/primitives/0/attributes/POSITION", positions);
    builder.set("/nodes/0/mesh", 0).set("/scenes/0/nodes/0", 0);
    return builder;
}

GltfBuilder GltfBuilder::square() {
    GltfBuilder builder;
    const std::string attributes = "/meshes/0/primitives/0/attributes/";
    builder.set(attributes + "POSITION",
                builder.accessor(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    builder.set(attributes + "NORMAL", builder.accessor(std::vector<glm::vec3>(4, {0, 0, 1})));
    builder.set(attributes + "TEXCOORD_0",
                builder.accessor(std::vector<glm::vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
    builder.set("/meshes/0/primitives/0/indices",
                builder.accessor(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR"));
    builder.set("/meshes/0/primitives/0/material", 0).set("/materials/0", "{}");
    builder.set("/nodes/0/mesh", 0).set("/scenes/0/nodes/0", 0);
    return builder;
}

GltfBuilder& GltfBuilder::set(const std::string& pointer, const std::string& text) {
    (*json_)[json::json_pointer(pointer)] = json::parse(text);
    lengthGiven_ = lengthGiven_ || pointer == "/buffers/0/byteLength";
    return *this;
}

GltfBuilder& GltfBuilder::erase(const std::string& pointer) {
    const json::json_pointer place(pointer);
    (*json_)[place.parent_pointer()].erase(place.back());
    return *this;
}

uint32_t GltfBuilder::view(std::span<const std::byte> bytes, uint32_t stride) {
    binary_.resize((binary_.size() + 7) / 8 * 8);
    json node{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) {
        node["byteStride"] = stride;
    }
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    (*json_)["bufferViews"].push_back(node);
    return static_cast<uint32_t>((*json_)["bufferViews"].size() - 1);
}

uint32_t GltfBuilder::offsetOf(uint32_t view) const {
    return json_->at("bufferViews").at(view).at("byteOffset");
}

uint32_t GltfBuilder::accessorOf(uint32_t view, const char* type, uint32_t componentType, size_t count,
                                 bool normalized) {
    json node{{"bufferView", view}, {"type", type}, {"componentType", componentType}, {"count", count}};
    if (normalized) {
        node["normalized"] = true;
    }
    (*json_)["accessors"].push_back(node);
    return static_cast<uint32_t>((*json_)["accessors"].size() - 1);
}

size_t GltfBuilder::size(const std::string& pointer) const {
    const json::json_pointer place(pointer);
    return json_->contains(place) ? json_->at(place).size() : 0;
}

void GltfBuilder::setByteLength() {
    if (!lengthGiven_) {
        (*json_)["buffers"][0]["byteLength"] = binary_.size();
    }
}

std::filesystem::path GltfBuilder::writeGltf(const std::filesystem::path& folder, const std::string& name) {
    setByteLength();
    json& uri = (*json_)["buffers"][0]["uri"];
    if (uri.is_null() || uri == "scene.bin") {
        uri = "scene.bin";
        writeBytes(folder / "scene.bin", binary_);
    }
    writeText(folder / name, json_->dump());
    return folder / name;
}

std::filesystem::path GltfBuilder::writeEmbedded(const std::filesystem::path& folder,
                                                 const std::string& name) {
    (*json_)["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(binary_);
    return writeGltf(folder, name);
}

std::filesystem::path GltfBuilder::writeGlb(const std::filesystem::path& folder, const std::string& name) {
    setByteLength();
    std::string text = json_->dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary_.resize((binary_.size() + 3) / 4 * 4);
    std::vector<std::byte> glb;
    for (uint32_t word :
         {0x46546C67u, 2u, uint32_t(28 + text.size() + binary_.size()), uint32_t(text.size()), 0x4E4F534Au}) {
        appendU32(glb, word);
    }
    const auto bytes = std::as_bytes(std::span(text));
    glb.insert(glb.end(), bytes.begin(), bytes.end());
    appendU32(glb, static_cast<uint32_t>(binary_.size()));
    appendU32(glb, 0x004E4942u);
    glb.insert(glb.end(), binary_.begin(), binary_.end());
    writeBytes(folder / name, glb);
    return folder / name;
}

void writeBytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void writeText(const std::filesystem::path& path, const std::string& text) {
    writeBytes(path, std::as_bytes(std::span(text)));
}

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k) {
            bits = bits << 8 | (i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0u);
        }
        for (size_t k = 0; k < 4; ++k) {
            text += k <= bytes.size() - i ? alphabet[bits >> (18 - 6 * k) & 63] : '=';
        }
    }
    return text;
}

std::vector<std::byte> encodePng(uint32_t width, uint32_t height, uint32_t channels, uint32_t bits,
                                 const std::vector<uint16_t>& values) {
    std::vector<std::byte> raw;
    for (size_t i = 0; i < values.size(); ++i) {
        if (i % (size_t{width} * channels) == 0) {
            raw.push_back(std::byte{0});  // no row filter
        }
        if (bits == 16) {
            raw.push_back(static_cast<std::byte>(values[i] >> 8));
        }
        raw.push_back(static_cast<std::byte>(values[i] & 0xff));
    }
    std::vector<std::byte> png;
    for (uint32_t byte : {0x89u, 0x50u, 0x4Eu, 0x47u, 0x0Du, 0x0Au, 0x1Au, 0x0Au}) {
        png.push_back(static_cast<std::byte>(byte));
    }
    std::vector<std::byte> header;
    appendBigU32(header, width);
    appendBigU32(header, height);
    for (uint32_t byte : {bits, channels == 4 ? 6u : 2u, 0u, 0u, 0u}) {
        header.push_back(static_cast<std::byte>(byte));
    }
    appendPngChunk(png, "IHDR", header);
    appendPngChunk(png, "IDAT", zlibStored(raw));
    appendPngChunk(png, "IEND", {});
    return png;
}

}  // namespace tilefarm
