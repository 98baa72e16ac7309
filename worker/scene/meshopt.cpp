#include "worker/scene/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>

#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

// No mode stores an element in fewer than 1/64 of its bytes, so a larger claim is a fault and not worth
// the memory.
constexpr uint64_t kMaxRatio = 128;

JsonNode extensionOf(const JsonNode& view) {
    const JsonNode extensions = view["extensions"];
    const JsonNode khronos = extensions["KHR_meshopt_compression"];
    return khronos ? khronos : extensions["EXT_meshopt_compression"];
}

MeshoptMode parseMode(const JsonNode& node) {
    const std::string& name = node.text();
    if (name == "ATTRIBUTES") return MeshoptMode::attributes;
    if (name == "TRIANGLES") return MeshoptMode::triangles;
    if (name == "INDICES") return MeshoptMode::indices;
    node.fail(fmt::format("is \"{}\", must be ATTRIBUTES, TRIANGLES or INDICES", name));
}

MeshoptFilter parseFilter(const JsonNode& node) {
    const std::string name = node.textOr("NONE");
    if (name == "NONE") return MeshoptFilter::none;
    if (name == "OCTAHEDRAL") return MeshoptFilter::octahedral;
    if (name == "QUATERNION") return MeshoptFilter::quaternion;
    if (name == "EXPONENTIAL") return MeshoptFilter::exponential;
    if (name == "COLOR") return MeshoptFilter::colour;
    node.fail(fmt::format("is \"{}\", must be NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR", name));
}

/// The decoders assert these rather than report them.
void checkLayout(const MeshoptView& view, const JsonNode& extension) {
    const JsonNode stride = extension["byteStride"];
    if (view.mode == MeshoptMode::attributes) {
        if (view.stride == 0 || view.stride % 4 != 0) {
            stride.fail(fmt::format("must be a multiple of 4 of 4 … 256, is {}", view.stride));
        }
    } else {
        if (view.stride != 2 && view.stride != 4) {
            stride.fail(fmt::format("must be 2 or 4 for indices, is {}", view.stride));
        }
        if (view.filter != MeshoptFilter::none) {
            extension["filter"].fail("must be NONE for indices");
        }
    }
    if (view.mode == MeshoptMode::triangles && view.count % 3 != 0) {
        extension["count"].fail(fmt::format("must be a multiple of 3 for triangles, is {}", view.count));
    }
    if (view.filter == MeshoptFilter::octahedral && view.stride != 4 && view.stride != 8) {
        stride.fail(fmt::format("must be 4 or 8 for the octahedral filter, is {}", view.stride));
    }
    if (view.filter == MeshoptFilter::colour && view.stride != 4 && view.stride != 8) {
        stride.fail(fmt::format("must be 4 or 8 for the filter of colours, is {}", view.stride));
    }
    if (view.filter == MeshoptFilter::quaternion && view.stride != 8) {
        stride.fail(fmt::format("must be 8 for the quaternion filter, is {}", view.stride));
    }
}

int decode(const MeshoptView& view, std::span<const std::byte> compressed, std::byte* out) {
    const auto* data = reinterpret_cast<const unsigned char*>(compressed.data());
    switch (view.mode) {
        case MeshoptMode::attributes:
            return meshopt_decodeVertexBuffer(out, view.count, view.stride, data, compressed.size());
        case MeshoptMode::triangles:
            return meshopt_decodeIndexBuffer(out, view.count, view.stride, data, compressed.size());
        case MeshoptMode::indices:
            return meshopt_decodeIndexSequence(out, view.count, view.stride, data, compressed.size());
    }
    return -1;
}

void applyFilter(const MeshoptView& view, std::byte* data) {
    switch (view.filter) {
        case MeshoptFilter::none:
        case MeshoptFilter::colour: break;  // never gets here, see meshoptLack
        case MeshoptFilter::octahedral: meshopt_decodeFilterOct(data, view.count, view.stride); break;
        case MeshoptFilter::quaternion: meshopt_decodeFilterQuat(data, view.count, view.stride); break;
        case MeshoptFilter::exponential: meshopt_decodeFilterExp(data, view.count, view.stride); break;
    }
}

}  // namespace

std::optional<MeshoptView> parseMeshopt(const JsonNode& view, size_t bufferCount) {
    const JsonNode extension = extensionOf(view);
    if (!extension) {
        return std::nullopt;
    }
    MeshoptView result;
    result.buffer = extension["buffer"].index(bufferCount, "/buffers");
    result.offset = extension["byteOffset"].integerOr(0, kMaxBufferBytes);
    result.length = extension["byteLength"].integer(kMaxBufferBytes);
    result.stride = static_cast<uint32_t>(extension["byteStride"].integer(256));
    result.count = static_cast<uint32_t>(extension["count"].integer(kMaxElements));
    result.mode = parseMode(extension["mode"]);
    result.filter = parseFilter(extension["filter"]);
    checkLayout(result, extension);
    const uint64_t decoded = uint64_t{result.count} * result.stride;
    if (decoded != view["byteLength"].integer(kMaxBufferBytes)) {
        extension["count"].fail(fmt::format("gives {} bytes, but the view has {}", decoded,
                                            view["byteLength"].integer(kMaxBufferBytes)));
    }
    if (decoded / kMaxRatio > result.length) {
        extension["count"].fail(fmt::format("{} bytes cannot hold {} elements", result.length, result.count));
    }
    return result;
}

std::string meshoptLack(const MeshoptView& view, std::span<const std::byte> compressed) {
    // The first byte holds the codec in its upper half and the bitstream's version in the lower one.
    constexpr std::byte kAttributesOfVersion1{0xa1};
    std::string lack;
    if (view.filter == MeshoptFilter::colour) {
        lack = "the filter COLOR";
    } else if (view.mode == MeshoptMode::attributes && !compressed.empty() &&
               compressed[0] == kAttributesOfVersion1) {
        lack = "version 1 of the bitstream of attributes";
    }
    return lack.empty()
               ? lack
               : fmt::format(
                     "uses {} of KHR_meshopt_compression, which libmeshoptimizer {}.{} does not decode", lack,
                     MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION % 1000 / 10);
}

std::vector<std::byte> decodeMeshopt(const MeshoptView& view, std::span<const std::byte> compressed,
                                     const JsonNode& node) {
    std::vector<std::byte> decoded(size_t{view.count} * view.stride);
    if (view.count == 0) {
        return decoded;
    }
    if (decode(view, compressed, decoded.data()) != 0) {
        node.fail("its compressed data is malformed (EXT_meshopt_compression)");
    }
    applyFilter(view, decoded.data());
    return decoded;
}

}  // namespace tilefarm
