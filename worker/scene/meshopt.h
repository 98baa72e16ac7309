#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "worker/scene/json_node.h"

namespace tilefarm {

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential, colour };

/// The EXT_meshopt_compression object of a buffer view: where its compressed bytes lie and what they hold.
struct MeshoptView {
    uint32_t buffer = 0;
    uint64_t offset = 0, length = 0;
    uint32_t stride = 0, count = 0;
    MeshoptMode mode = MeshoptMode::attributes;
    MeshoptFilter filter = MeshoptFilter::none;
};

/// Reads and checks the extension of a buffer view, apart from its range in the buffer. Nothing where
/// the view has none.
std::optional<MeshoptView> parseMeshopt(const JsonNode& view, size_t bufferCount);

/// What the linked libmeshoptimizer lacks to decode these bytes, or an empty text: the filter COLOR and
/// version 1 of the bitstream of attributes are of KHR_meshopt_compression and younger than Debian 12's.
std::string meshoptLack(const MeshoptView& view, std::span<const std::byte> compressed);

/// The decoded bytes: count * stride of them. Faults are reported at `node`.
std::vector<std::byte> decodeMeshopt(const MeshoptView& view, std::span<const std::byte> compressed,
                                     const JsonNode& node);

}  // namespace tilefarm
