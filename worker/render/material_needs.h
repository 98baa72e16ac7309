#pragma once

#include "worker/scene/scene.h"

/// What a lit material may show somewhere: the conditions of shaders/tables/materials.py. A texture can only
/// lower metallic and transmission, so with one any lower value may occur.
namespace tilefarm {

inline bool hasDielectric(const Material& m) {
    return m.metallic < 1 || m.metallicRoughnessTexture;
}

inline bool hasDiffuse(const Material& m) {
    return hasDielectric(m) && (m.transmission < 1 || m.transmissionTexture);
}

inline bool hasDisneyDiffuse(const Material& m) {
    return m.disneyDiffuse || m.subsurface > 0;
}

/// Reflection or refraction: more than a matte surface.
inline bool hasInterface(const Material& m) {
    return m.metallic > 0 || (m.ior != 1 && m.specular > 0) || m.iridescence > 0 || m.transmission > 0;
}

inline bool refracts(const Material& m) {
    return m.transmission > 0 && m.thickness > 0;
}

}  // namespace tilefarm
