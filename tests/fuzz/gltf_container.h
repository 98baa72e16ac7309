#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tests/fuzz/json_mutator.h"

namespace tilefarm::fuzz {

/// A .gltf or .glb taken apart so that its parts can be changed each by itself.
struct GltfContainer {
    Json json;
    std::optional<std::vector<std::byte>> binary;  // the second chunk of a GLB
    bool glb = false;

    /// Nothing where the JSON does not parse.
    static std::optional<GltfContainer> parse(std::span<const std::byte> bytes);
    /// The file again, with chunks of the lengths that they have.
    std::vector<std::byte> bytes() const;

    /// The bytes of buffer 0: the binary chunk's, or those of a data URI in base64.
    std::vector<std::byte> buffer() const;
    /// Puts them back where they came from; their length is given as they have it.
    void setBuffer(const std::vector<std::byte>& bytes);
    /// From one kind of file to the other; buffer 0 goes along where it is embedded.
    void turnIntoOther();
};

}  // namespace tilefarm::fuzz
