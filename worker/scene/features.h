#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "worker/scene/scene.h"

namespace tilefarm {

/// The effects that a scene may call for. A kernel is built with just those that it does.
enum class SceneFeature : uint32_t {
    textures,          // any texture at all
    uvSet1,            // a texture reads TEXCOORD_1
    textureTransform,  // a texture has a transform that is not the identity
    normalMaps,
    smoothNormals,  // a mesh has normals
    vertexColors,
    alphaMask,        // some surface may be cut out
    alphaBlend,       // some surface may be partly transparent
    singleSided,      // some material is not double sided
    metallic,         // some metallic may be above 0
    roughReflection,  // some alpha may be at or above kMirrorAlpha
    smoothMirror,     // some alpha may be below kMirrorAlpha
    transmission,
    volumeAttenuation,  // solid and coloured
    thinWalled,         // transmission with thickness 0
    emissiveTriangles,
    emissiveTextures,
    pointLights,
    spotLights,
    directionalLights,
    environment,
    unlit,
    count
};

/// A GGX alpha (roughness squared) below this is rendered as a perfect mirror.
inline constexpr float kMirrorAlpha = 1e-3f;

struct SceneFeatures {
    uint32_t bits = 0;
    bool has(SceneFeature feature) const { return bits >> static_cast<uint32_t>(feature) & 1; }
    void add(SceneFeature feature, bool present = true) {
        bits |= uint32_t{present} << static_cast<uint32_t>(feature);
    }
    friend bool operator==(const SceneFeatures&, const SceneFeatures&) = default;
};

/// "normalMaps", as in the enumeration.
const char* featureName(SceneFeature feature);
std::vector<std::string> featureNames(SceneFeatures features);

/// What the instances of the scene can show: materials, textures and attributes that no triangle uses do not
/// count, nor does a map whose texels all say what its absence would. Never leaves out what is seen.
SceneFeatures detectFeatures(const Scene& scene);

}  // namespace tilefarm
