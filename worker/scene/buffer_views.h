#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "worker/scene/gltf_file.h"
#include "worker/scene/meshopt.h"
#include "worker/scene/part_list.h"

namespace tilefarm {

/// The buffers and buffer views of a glTF file. Construction checks every range, and a broken view is a
/// warning until it is asked for (part_list.h); bytes are loaded and decompressed when first asked for.
/// Throws Error(invalidArgument) with the place of the fault.
class BufferViews {
public:
    explicit BufferViews(const GltfFile& file);

    size_t count() const { return views_.size(); }
    uint64_t length(uint32_t view) const { return views_[view].length; }
    /// Bytes from one element to the next, 0 where elements follow each other.
    uint32_t stride(uint32_t view) const { return views_[view].stride; }
    /// length(view) bytes, valid as long as this lives.
    std::span<const std::byte> bytes(uint32_t view);

private:
    struct View {
        uint32_t buffer = 0;
        uint64_t offset = 0, length = 0;
        uint32_t stride = 0;
        std::optional<MeshoptView> compressed;
        std::optional<std::vector<std::byte>> decoded;
    };
    struct Buffer {
        uint64_t length = 0;
        std::optional<std::vector<std::byte>> loaded;
    };

    View parseView(const JsonNode& node) const;
    std::span<const std::byte> buffer(uint32_t index);
    bool hasBytes(uint32_t buffer) const;

    const GltfFile& file_;
    PartList<Buffer> buffers_;
    PartList<View> views_;
};

}  // namespace tilefarm
