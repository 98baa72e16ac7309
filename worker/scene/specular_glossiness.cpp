// KHR_materials_pbrSpecularGlossiness (archived) as metallic-roughness with KHR_materials_specular:
//
//     c_diff = diffuse (1 - max(specular)),  F0 = specular,  roughness = 1 - glossiness,
//
// metallic 0 and an index of refraction of 0, for which F0 is the specular colour. Factors convert exactly.
// Textures of 8 bits stay such, so baked texels are off by half a step at most; those of 16 bits are exact.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/scene/material_reader.h"

namespace tilefarm {
namespace {

// IEC 61966-2-1.
float srgbToLinear(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
float linearToSrgb(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}
uint8_t toByte(float v) {
    return static_cast<uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f);
}

const std::array<float, 256>& linearOfByte() {
    static const auto table = [] {
        std::array<float, 256> values{};
        for (size_t i = 0; i < values.size(); ++i) {
            values[i] = srgbToLinear(static_cast<float>(i) / 255);
        }
        return values;
    }();
    return table;
}

/// A colour image's texel, linear; images read as colours are sRGB in bytes and linear in floats.
glm::vec4 texel(const Image& image, uint32_t x, uint32_t y) {
    const size_t at = (size_t{y} * image.width + x) * 4;
    if (!image.rgbaFloat.empty()) {
        const float* t = image.rgbaFloat.data() + at;
        return {t[0], t[1], t[2], t[3]};
    }
    const uint8_t* t = image.rgba8.data() + at;
    const auto& linear = linearOfByte();
    return {linear[t[0]], linear[t[1]], linear[t[2]], static_cast<float>(t[3]) / 255};
}

/// Bilinear at a texel centre of a grid of another size; where the sizes agree, the texel itself.
glm::vec4 resampled(const Image& image, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    const auto split = [](uint32_t at, uint32_t size, uint32_t wanted) {
        const double place = std::clamp((at + 0.5) * size / wanted - 0.5, 0.0, static_cast<double>(size - 1));
        const auto first = static_cast<uint32_t>(place);
        return std::pair(first, static_cast<float>(place - first));
    };
    const auto [x0, fx] = split(x, image.width, width);
    const auto [y0, fy] = split(y, image.height, height);
    const uint32_t x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    return glm::mix(glm::mix(texel(image, x0, y0), texel(image, x1, y0), fx),
                    glm::mix(texel(image, x0, y1), texel(image, x1, y1), fx), fy);
}

/// g: 1 - glossiness · alpha.
Image roughnessImage(const Image& source, float glossiness) {
    Image image{source.name + " as roughness", source.width, source.height, source.rgba8, source.rgbaFloat};
    for (size_t i = 0; i < image.rgba8.size(); i += 4) {
        image.rgba8[i + 1] = toByte(1 - glossiness * static_cast<float>(source.rgba8[i + 3]) / 255);
    }
    for (size_t i = 0; i < image.rgbaFloat.size(); i += 4) {
        image.rgbaFloat[i + 1] = 1 - glossiness * source.rgbaFloat[i + 3];
    }
    return image;
}

/// rgb: diffuse · (1 - max(factor · specular)), alpha as it is. `diffuse` may be null: white.
Image darkenedImage(const Image* diffuse, const Image& specular, const glm::vec3& factor) {
    Image image;
    image.name = (diffuse ? diffuse : &specular)->name + " without what is reflected";
    image.width = std::max(specular.width, diffuse ? diffuse->width : 1);
    image.height = std::max(specular.height, diffuse ? diffuse->height : 1);
    const bool floats = !specular.rgbaFloat.empty() || (diffuse && !diffuse->rgbaFloat.empty());
    const size_t values = size_t{image.width} * image.height * 4;
    if (floats) {
        image.rgbaFloat.reserve(values);
    } else {
        image.rgba8.reserve(values);
    }
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const glm::vec3 s = glm::vec3(resampled(specular, x, y, image.width, image.height)) * factor;
            glm::vec4 d = diffuse ? resampled(*diffuse, x, y, image.width, image.height) : glm::vec4(1);
            d = glm::vec4(glm::vec3(d) * (1 - std::max({s.x, s.y, s.z})), d.w);
            for (int c = 0; c < 4; ++c) {
                if (floats) {
                    image.rgbaFloat.push_back(d[c]);
                } else {
                    image.rgba8.push_back(toByte(c < 3 ? linearToSrgb(d[c]) : d[c]));
                }
            }
        }
    }
    return image;
}

bool readAlike(const TextureRef& a, const TextureRef& b) {
    return a.uvSet == b.uvSet && a.wrapS == b.wrapS && a.wrapT == b.wrapT &&
           a.linearFilter == b.linearFilter && a.transform == b.transform;
}

/// The diffuse colour loses what is reflected, texel by texel.
void darken(MaterialReader& reader, Material& m, const TextureRef& specular) {
    const glm::vec3 f = m.specularColor;
    if (!specular) {
        m.baseColor *= 1 - std::max({f.x, f.y, f.z});
        return;
    }
    const bool textured = static_cast<bool>(m.baseColorTexture);
    if (textured && !readAlike(m.baseColorTexture, specular)) {
        reader.warn(
            "KHR_materials_pbrSpecularGlossiness",
            "its two textures have different texture coordinates or transforms: the diffuse colour is not "
            "darkened by the specular one, except by Fresnel reflection");
        return;
    }
    std::vector<TextureRef> sources{specular};
    if (textured) {
        sources.push_back(m.baseColorTexture);
    }
    m.baseColorTexture = reader.textures().derive(
        sources, fmt::format("diffuse less {} {} {}", f.x, f.y, f.z), [f](const std::vector<Image>& images) {
            const Image* diffuse = images.size() > 1 ? &images[1] : nullptr;
            return darkenedImage(diffuse, images[0], f);
        });
}

}  // namespace

bool readSpecularGlossiness(MaterialReader& reader, Material& m) {
    const JsonNode pbr = reader.extension("KHR_materials_pbrSpecularGlossiness");
    if (!pbr) {
        return false;
    }
    m.metallic = 0;
    m.ior = 0;
    m.specular = 1;
    m.specularTexture = {};
    const glm::vec4 diffuse = reader.colorAndAlpha(pbr["diffuseFactor"]);
    m.baseColor = glm::vec3(diffuse);
    m.alpha = diffuse.w;
    m.baseColorTexture = reader.colorTexture(pbr["diffuseTexture"]);
    m.specularColor = reader.color(pbr["specularFactor"], glm::vec3(1));
    const TextureRef texture = reader.colorTexture(pbr["specularGlossinessTexture"]);
    m.specularColorTexture = texture;
    const float glossiness = reader.factor(pbr["glossinessFactor"], 1);
    m.roughness = 1 - glossiness;
    if (texture) {
        m.roughness = 1;
        m.metallicRoughnessTexture = reader.textures().derive(
            {texture}, fmt::format("roughness of {}", glossiness),
            [glossiness](const std::vector<Image>& images) { return roughnessImage(images[0], glossiness); });
        m.metallicRoughnessTexture.srgb = false;
    }
    darken(reader, m, texture);
    return true;
}

}  // namespace tilefarm
