#pragma once

#include <functional>
#include <map>
#include <string>
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

    /// A texture read as the first of `sources` is, of an image that `make` computes from theirs, decoded as
    /// colours, once they are. References with the same sources and `key` share it.
    using MakeImage = std::function<Image(const std::vector<Image>& sources)>;
    TextureRef derive(const std::vector<TextureRef>& sources, const std::string& key, MakeImage make);

    /// Decodes the images that the materials marked in `used` refer to into scene.images and makes their
    /// references point there; the others lose theirs.
    void decodeUsed(std::vector<Material>& materials, const std::vector<bool>& used);

private:
    uint32_t imageOf(const JsonNode& texture);
    void parseSampler(const JsonNode& texture, TextureRef& ref);
    std::vector<std::byte> encodedBytes(const JsonNode& image);
    Image decodeFile(uint32_t image, bool srgb);
    Image makeDerived(uint32_t image);
    uint32_t addToScene(const TextureRef& ref);

    struct Derived {
        std::vector<uint32_t> sources;  // indices into images_
        std::string key;
        MakeImage make;
    };

    LoadContext& load_;
    JsonNode textures_, images_, samplers_;
    std::vector<Derived> derived_;  // references count on from images_
    // 16-bit images differ by how their texels are encoded, so the key has that too.
    std::map<std::pair<uint32_t, bool>, uint32_t> inScene_;
    uint64_t texels_ = 0;
};

/// The texture references of a material, for everything that treats them alike.
template <typename MaterialType, typename Visit>
void forEachTexture(MaterialType& material, Visit visit) {
    visit(material.baseColorTexture);
    visit(material.metallicRoughnessTexture);
    visit(material.normalTexture);
    visit(material.emissionTexture);
    visit(material.transmissionTexture);
    visit(material.specularTexture);
    visit(material.specularColorTexture);
    visit(material.clearcoatTexture);
    visit(material.clearcoatRoughnessTexture);
    visit(material.clearcoatNormalTexture);
    visit(material.sheenColorTexture);
    visit(material.sheenRoughnessTexture);
    visit(material.anisotropyTexture);
    visit(material.iridescenceTexture);
    visit(material.iridescenceThicknessTexture);
    visit(material.diffuseTransmissionTexture);
    visit(material.diffuseTransmissionColorTexture);
}

}  // namespace tilefarm
