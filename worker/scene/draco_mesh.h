#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "worker/scene/json_node.h"

namespace tilefarm {

/// A mesh decoded from KHR_draco_mesh_compression. Faults are reported at `node`, the extension object.
class DracoMesh {
public:
    DracoMesh(std::span<const std::byte> compressed, const JsonNode& node);
    ~DracoMesh();

    uint32_t vertexCount() const;
    /// Three per triangle.
    std::vector<uint32_t> indices() const;
    /// vertexCount() * components values of the attribute that the extension calls `name`.
    std::vector<float> attribute(const std::string& name, uint32_t components, bool normalized) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    JsonNode node_;
};

}  // namespace tilefarm
