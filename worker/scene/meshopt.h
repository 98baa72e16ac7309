#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "worker/scene/json_node.h"

namespace tilefarm {

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

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

/// The decoded bytes: count * stride of them. Faults are reported at `node`.
std::vector<std::byte> decodeMeshopt(const MeshoptView& view, std::span<const std::byte> compressed,
                                     const JsonNode& node);

}  // namespace tilefarm
