#include "worker/scene/textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/error/error.h"
#include "worker/scene/decode_image.h"
#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

Wrap parseWrap(const JsonNode& node) {
    switch (node.integerOr(10497, 0xffff)) {
        case 10497: return Wrap::repeat;
        case 33648: return Wrap::mirror;
        case 33071: return Wrap::clamp;
    }
    node.fail(fmt::format("is {}, must be 10497, 33648 or 33071", node.integer(0xffff)));
}

/// KHR_texture_transform: uv' = translation * rotation * scale * uv. The rotation is counter-clockwise as
/// seen with v pointing down, as in the extension's example.
glm::mat3x2 parseTransform(const JsonNode& node) {
    std::vector<double> offset{0, 0}, scale{1, 1};
    if (node["offset"]) offset = node["offset"].numbers(2);
    if (node["scale"]) scale = node["scale"].numbers(2);
    const double rotation = node["rotation"].numberOr(0);
    const double c = std::cos(rotation), s = std::sin(rotation);
    const double values[] = {c * scale[0], -s * scale[0], s * scale[1], c * scale[1], offset[0], offset[1]};
    for (double value : values) {
        if (!(std::abs(value) <= std::numeric_limits<float>::max())) {
            node.fail("is too large");
        }
    }
    return glm::mat3x2(values[0], values[1], values[2], values[3], values[4], values[5]);
}

}  // namespace

Textures::Textures(LoadContext& load)
    : load_(load),
      textures_(load.file.root()["textures"]),
      images_(load.file.root()["images"]),
      samplers_(load.file.root()["samplers"]) {
    for (size_t i = 0; i < images_.size(); ++i) {
        readIfSound(images_[i], [&] {
            if (const JsonNode view = images_[i]["bufferView"]) {
                view.index(load.views.count(), "/bufferViews");
            } else {
                load.file.requireThere(images_[i]["uri"]);
            }
        });
    }
}

TextureRef Textures::parse(const JsonNode& info, bool srgb) {
    TextureRef ref;
    if (!info) {
        return ref;
    }
    const JsonNode texture = textures_[info["index"].index(textures_.size(), "/textures")];
    uint64_t uvSet = info["texCoord"].integerOr(0, 0xffff);
    if (const JsonNode transform = info["extensions"]["KHR_texture_transform"]) {
        ref.transform = parseTransform(transform);
        uvSet = transform["texCoord"].integerOr(uvSet, 0xffff);
    }
    if (uvSet > 1) {
        load_.warn(fmt::format("TEXCOORD_{}", uvSet), info, "rendered without this texture");
        return {};
    }
    ref.uvSet = static_cast<uint32_t>(uvSet);
    ref.srgb = srgb;
    parseSampler(texture, ref);
    ref.image = imageOf(texture);
    return ref.image == kNone ? TextureRef{} : ref;
}

void Textures::parseSampler(const JsonNode& texture, TextureRef& ref) {
    const JsonNode index = texture["sampler"];
    if (!index) {
        return;
    }
    const JsonNode sampler = samplers_[index.index(samplers_.size(), "/samplers")];
    ref.wrapS = parseWrap(sampler["wrapS"]);
    ref.wrapT = parseWrap(sampler["wrapT"]);
    // Minification is what averaging samples does; the magnification filter is what is left to choose.
    ref.linearFilter = sampler["magFilter"].integerOr(9729, 0xffff) != 9728;
}

uint32_t Textures::imageOf(const JsonNode& texture) {
    for (const std::string& name : texture["extensions"].keys()) {
        if (texture["extensions"][name]["source"]) {
            load_.warn(name, texture,
                       texture["source"] ? "rendered with the texture's other image"
                                         : "rendered without this texture");
        }
    }
    const JsonNode source = texture["source"];
    return source ? source.index(images_.size(), "/images") : kNone;
}

std::vector<std::byte> Textures::encodedBytes(const JsonNode& image) {
    if (const JsonNode view = image["bufferView"]) {
        const auto bytes = load_.views.bytes(view.index(load_.views.count(), "/bufferViews"));
        return {bytes.begin(), bytes.end()};
    }
    return load_.file.read(image["uri"]);
}

Image Textures::decodeFile(uint32_t image, bool srgb) {
    const JsonNode node = images_[image];
    try {
        Image decoded = decodeImage(encodedBytes(node), srgb);
        decoded.name = node["name"].textOr(node["uri"].isString() && node["uri"].text().size() < 256
                                               ? node["uri"].text()
                                               : fmt::format("images/{}", image));
        return decoded;
    } catch (const Error& fault) {
        if (!fault.faults.empty()) {
            throw;  // names its place already
        }
        node.fail(fault.what());
    }
}

TextureRef Textures::derive(const std::vector<TextureRef>& sources, const std::string& key, MakeImage make) {
    Derived wanted{{}, key, std::move(make)};
    for (const TextureRef& source : sources) {
        wanted.sources.push_back(source.image);
    }
    const auto same = [&](const Derived& d) { return d.sources == wanted.sources && d.key == wanted.key; };
    const auto known = std::find_if(derived_.begin(), derived_.end(), same);
    TextureRef ref = sources.front();
    ref.image = static_cast<uint32_t>(images_.size() + static_cast<size_t>(known - derived_.begin()));
    if (known == derived_.end()) {
        derived_.push_back(std::move(wanted));
    }
    return ref;
}

Image Textures::makeDerived(uint32_t image) {
    const Derived& derived = derived_[image - images_.size()];
    std::vector<Image> sources;
    for (const uint32_t source : derived.sources) {
        sources.push_back(decodeFile(source, true));
    }
    return derived.make(sources);
}

uint32_t Textures::addToScene(const TextureRef& ref) {
    const auto key = std::pair(ref.image, ref.srgb);
    if (const auto known = inScene_.find(key); known != inScene_.end()) {
        return known->second;
    }
    std::vector<Image>& images = load_.scene.images;
    const bool isFile = ref.image < images_.size();
    images.push_back(isFile ? decodeFile(ref.image, ref.srgb) : makeDerived(ref.image));
    texels_ += uint64_t{images.back().width} * images.back().height;
    if (texels_ > kMaxSceneTexels) {
        const JsonNode node = images_[isFile ? ref.image : derived_[ref.image - images_.size()].sources[0]];
        node.fail(fmt::format("with this image the scene has more than {} texels", kMaxSceneTexels));
    }
    const auto index = static_cast<uint32_t>(images.size() - 1);
    inScene_[key] = index;
    if (!images[index].rgba8.empty()) {
        inScene_[{key.first, !key.second}] = index;
    }
    return index;
}

void Textures::decodeUsed(std::vector<Material>& materials, const std::vector<bool>& used) {
    for (size_t i = 0; i < materials.size(); ++i) {
        forEachTexture(materials[i], [&](TextureRef& ref) {
            if (!ref) {
                return;
            }
            if (!used[i]) {
                ref = TextureRef{};
                return;
            }
            ref.image = addToScene(ref);
            ref.srgb = ref.srgb && !load_.scene.images[ref.image].rgba8.empty();
        });
    }
}

}  // namespace tilefarm
