#include "worker/scene/buffer_views.h"

#include <fmt/format.h>

#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

void checkRange(uint64_t offset, uint64_t length, uint64_t available, const JsonNode& node) {
    // Both are below 2^34, so the sum cannot overflow.
    if (offset + length > available) {
        node.fail(
            fmt::format("bytes {} … {} lie outside of the buffer's {}", offset, offset + length, available));
    }
}

}  // namespace

BufferViews::BufferViews(const GltfFile& file) : file_(file) {
    const JsonNode buffers = file.root()["buffers"];
    for (size_t i = 0; i < buffers.size(); ++i) {
        buffers_.add(buffers[i], [&] {
            return Buffer{buffers[i]["byteLength"].integer(kMaxBufferBytes), std::nullopt};
        });
        // One that is missing may be the fallback of what is compressed, or of an animation that does not
        // play.
        if (const JsonNode uri = buffers[i]["uri"]) {
            readIfSound(buffers[i], [&] { file.requireThere(uri); });
        }
    }
    const JsonNode views = file.root()["bufferViews"];
    for (size_t i = 0; i < views.size(); ++i) {
        views_.add(views[i], [&] { return parseView(views[i]); });
    }
}

BufferViews::View BufferViews::parseView(const JsonNode& node) const {
    View view;
    view.buffer = node["buffer"].index(buffers_.size(), "/buffers");
    view.offset = node["byteOffset"].integerOr(0, kMaxBufferBytes);
    view.length = node["byteLength"].integer(kMaxBufferBytes);
    checkRange(view.offset, view.length, buffers_[view.buffer].length, node);
    view.stride = static_cast<uint32_t>(node["byteStride"].integerOr(0, 252));
    if (node["byteStride"] && view.stride == 0) {
        node["byteStride"].tolerate("must be an integer of 4 … 252, is 0", "read as if it were not given");
    } else if (node["byteStride"] && view.stride < 4) {
        node["byteStride"].fail(fmt::format("must be an integer of 4 … 252, is {}", view.stride));
    }
    view.compressed = parseMeshopt(node, buffers_.size());
    if (const auto& compressed = view.compressed) {
        checkRange(compressed->offset, compressed->length, buffers_[compressed->buffer].length,
                   node["extensions"]);
        if (view.stride != 0 && view.stride != compressed->stride) {
            node["byteStride"].fail("differs from the one of its compressed data");
        }
    }
    return view;
}

std::span<const std::byte> BufferViews::buffer(uint32_t index) {
    Buffer& buffer = buffers_[index];
    const JsonNode node = file_.root()["buffers"][index];
    std::span<const std::byte> bytes;
    if (buffer.loaded) {
        bytes = *buffer.loaded;
    } else if (const JsonNode uri = node["uri"]) {
        buffer.loaded = file_.read(uri);
        bytes = *buffer.loaded;
    } else if (index == 0 && file_.binaryChunk()) {
        bytes = *file_.binaryChunk();
    } else {
        node.fail("has no uri and no binary chunk, so it has no bytes");
    }
    if (bytes.size() < buffer.length) {
        node["byteLength"].fail(fmt::format("says {} bytes, but there are {}", buffer.length, bytes.size()));
    }
    return bytes.first(buffer.length);
}

/// Of its own: a buffer that compressed views alone stand in may have none.
bool BufferViews::hasBytes(uint32_t index) const {
    return file_.root()["buffers"][index]["uri"] || (index == 0 && file_.binaryChunk());
}

std::span<const std::byte> BufferViews::bytes(uint32_t index) {
    View& view = views_[index];
    if (!view.compressed) {
        return buffer(view.buffer).subspan(view.offset, view.length);
    }
    if (!view.decoded) {
        const MeshoptView& compressed = *view.compressed;
        const JsonNode node = file_.root()["bufferViews"][index];
        const auto data = buffer(compressed.buffer).subspan(compressed.offset, compressed.length);
        if (const std::string lack = meshoptLack(compressed, data); !lack.empty()) {
            if (!hasBytes(view.buffer)) {
                node["extensions"].fail(lack);
            }
            node.warn("meshopt compression", lack + "; its uncompressed bytes are read instead");
            return buffer(view.buffer).subspan(view.offset, view.length);
        }
        view.decoded = decodeMeshopt(compressed, data, node);
    }
    return *view.decoded;
}

}  // namespace tilefarm
