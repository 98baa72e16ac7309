#pragma once

#include <vector>

#include "worker/scene/load_context.h"

namespace tilefarm {

/// The textures of a glTF file. Materials are given references to the file's images; those that are
/// used are decoded once at the end.
class Textures {
public:
    explicit Textures(LoadContext& load);

    /// Reads a textureInfo object with its sampler and KHR_texture_transform. What cannot be rendered
    /// gives a warning and no texture. `srgb`: its texels are colours.
    TextureRef parse(const JsonNode& info, bool srgb);

    /// Decodes the images that the materials marked in `used` refer to into scene.images and makes their
    /// references point there; the others lose theirs.
    void decodeUsed(std::vector<Material>& materials, const std::vector<bool>& used);

private:
    uint32_t imageOf(const JsonNode& texture);
    void parseSampler(const JsonNode& texture, TextureRef& ref);
    std::vector<std::byte> encodedBytes(const JsonNode& image);

    LoadContext& load_;
    JsonNode textures_, images_, samplers_;
};

/// The texture references of a material, for everything that treats them alike.
template <typename MaterialType, typename Visit>
void forEachTexture(MaterialType& material, Visit visit) {
    visit(material.baseColorTexture);
    visit(material.metallicRoughnessTexture);
    visit(material.normalTexture);
    visit(material.emissionTexture);
    visit(material.transmissionTexture);
}

}  // namespace tilefarm
