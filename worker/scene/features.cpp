#include "worker/scene/features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "worker/scene/textures.h"

namespace tilefarm {
namespace {

constexpr std::array kNames{"textures",         "uvSet1",
                            "textureTransform", "normalMaps",
                            "smoothNormals",    "vertexColors",
                            "alphaMask",        "alphaBlend",
                            "singleSided",      "metallic",
                            "roughReflection",  "smoothMirror",
                            "transmission",     "volumeAttenuation",
                            "thinWalled",       "emissiveTriangles",
                            "emissiveTextures", "pointLights",
                            "spotLights",       "directionalLights",
                            "environment",      "unlit"};
static_assert(kNames.size() == static_cast<size_t>(SceneFeature::count));
static_assert(kNames.size() <= 32);

struct Range {
    float lower = 1, upper = 1;
};

/// Smallest and largest value of a channel; 1 and 1 without a texture, which is what factors multiply.
Range channelRange(const Scene& scene, const TextureRef& ref, size_t channel) {
    if (!ref) {
        return {};
    }
    const Image& image = scene.images[ref.image];
    Range range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    const auto widen = [&range](float value) {
        range = {std::min(range.lower, value), std::max(range.upper, value)};
    };
    for (size_t i = channel; i < image.rgba8.size(); i += 4) {
        widen(static_cast<float>(image.rgba8[i]) / 255.0f);
    }
    for (size_t i = channel; i < image.rgbaFloat.size(); i += 4) {
        widen(image.rgbaFloat[i]);
    }
    return range;
}

class Detector {
public:
    explicit Detector(const Scene& scene) : scene_(scene) {}

    SceneFeatures run() {
        addLights();
        std::vector<bool> meshDone(scene_.meshes.size(), false);
        std::vector<bool> materialDone(scene_.materials.size(), false);
        std::vector<float> lowestVertexAlpha(scene_.materials.size(), 1);
        for (const Instance& instance : scene_.instances) {
            const Mesh& mesh = scene_.meshes[instance.mesh];
            if (meshDone[instance.mesh] || mesh.triangles.empty()) {
                continue;
            }
            meshDone[instance.mesh] = true;
            materialDone[mesh.material] = true;
            out_.add(SceneFeature::vertexColors, !mesh.colors.empty());
            out_.add(SceneFeature::smoothNormals, !mesh.normals.empty());
            for (glm::vec4 color : mesh.colors) {
                lowestVertexAlpha[mesh.material] = std::min(lowestVertexAlpha[mesh.material], color.a);
            }
        }
        for (size_t i = 0; i < scene_.materials.size(); ++i) {
            if (materialDone[i]) {
                addMaterial(scene_.materials[i], lowestVertexAlpha[i]);
            }
        }
        return out_;
    }

private:
    void addLights() {
        for (const PunctualLight& light : scene_.lights) {
            const bool shines = light.color != glm::vec3(0);
            out_.add(SceneFeature::pointLights, shines && light.type == PunctualType::point);
            out_.add(SceneFeature::spotLights, shines && light.type == PunctualType::spot);
            out_.add(SceneFeature::directionalLights, shines && light.type == PunctualType::directional);
        }
        out_.add(SceneFeature::environment, scene_.hasEnvironment());
    }

    void addMaterial(const Material& material, float lowestVertexAlpha) {
        forEachTexture(material, [this](const TextureRef& ref) {
            out_.add(SceneFeature::textures, static_cast<bool>(ref));
            out_.add(SceneFeature::uvSet1, ref && ref.uvSet == 1);
            out_.add(SceneFeature::textureTransform, ref && ref.transform != TextureRef{}.transform);
        });
        out_.add(SceneFeature::normalMaps, static_cast<bool>(material.normalTexture));
        out_.add(SceneFeature::singleSided, !material.doubleSided);
        out_.add(SceneFeature::emissiveTriangles, material.emission != glm::vec3(0));
        out_.add(SceneFeature::emissiveTextures, static_cast<bool>(material.emissionTexture));
        addAlpha(material, lowestVertexAlpha);
        out_.add(SceneFeature::unlit, material.unlit);
        if (!material.unlit) {
            addReflection(material);
            addTransmission(material);
        }
    }

    void addAlpha(const Material& material, float lowestVertexAlpha) {
        if (material.alphaMode == AlphaMode::opaque) {
            return;
        }
        const float lowest =
            material.alpha * channelRange(scene_, material.baseColorTexture, 3).lower * lowestVertexAlpha;
        out_.add(SceneFeature::alphaMask,
                 material.alphaMode == AlphaMode::mask && lowest < material.alphaCutoff);
        out_.add(SceneFeature::alphaBlend, material.alphaMode == AlphaMode::blend && lowest < 1);
    }

    void addReflection(const Material& material) {
        const Range rough = channelRange(scene_, material.metallicRoughnessTexture, 1);
        const auto alpha = [&](float texel) {
            const float roughness = material.roughness * texel;
            return roughness * roughness;
        };
        out_.add(SceneFeature::smoothMirror, alpha(rough.lower) < kMirrorAlpha);
        out_.add(SceneFeature::roughReflection, alpha(rough.upper) >= kMirrorAlpha);
        const float metallic =
            material.metallic * channelRange(scene_, material.metallicRoughnessTexture, 2).upper;
        out_.add(SceneFeature::metallic, metallic > 0);
    }

    void addTransmission(const Material& material) {
        const float most =
            material.transmission * channelRange(scene_, material.transmissionTexture, 0).upper;
        if (!(most > 0)) {
            return;
        }
        out_.add(SceneFeature::transmission);
        out_.add(SceneFeature::thinWalled, material.thickness == 0);
        out_.add(SceneFeature::volumeAttenuation, material.thickness > 0 &&
                                                      std::isfinite(material.attenuationDistance) &&
                                                      material.attenuationColor != glm::vec3(1));
    }

    const Scene& scene_;
    SceneFeatures out_;
};

}  // namespace

const char* featureName(SceneFeature feature) {
    return kNames.at(static_cast<size_t>(feature));
}

std::vector<std::string> featureNames(SceneFeatures features) {
    std::vector<std::string> names;
    for (uint32_t i = 0; i < kNames.size(); ++i) {
        if (features.has(static_cast<SceneFeature>(i))) {
            names.emplace_back(kNames[i]);
        }
    }
    return names;
}

SceneFeatures detectFeatures(const Scene& scene) {
    return Detector(scene).run();
}

}  // namespace tilefarm
