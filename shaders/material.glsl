// Material parameters at a surface point: factors times textures times vertex colours.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL

#include "material_point.glsl"

vec4 baseColorAndAlpha(uint material, uint baseColorTexture, vec2 uv0, vec2 uv1, vec4 color) {
    vec4 base = vec4(materialBaseColor(material), materialAlpha(material)) * color;
    if (has(FEATURE_TEXTURES) && baseColorTexture != NO_INDEX) base *= sampleTexture(baseColorTexture, uv0, uv1);
    return base;
}

vec3 emissionAt(uint material, uint emissionTexture, vec2 uv0, vec2 uv1) {
    vec3 emission = materialEmission(material);
    if (has(FEATURE_TEXTURES) && emissionTexture != NO_INDEX) emission *= sampleTexture(emissionTexture, uv0, uv1).rgb;
    return emission;
}

#include "material_interface.glsl"
#include "material_layers.glsl"

MaterialPoint materialAt(Surface s) {
    MaterialPoint m;
    m.baseColor = baseColorAndAlpha(s.material, materialBaseColorTexture(s.material), s.uv0, s.uv1, s.color).rgb;
    m.metallic = materialMetallic(s.material);
    float roughness = materialRoughness(s.material);
    uint metallicRoughnessTexture = materialMetallicRoughnessTexture(s.material);
    if (has(FEATURE_TEXTURES) && metallicRoughnessTexture != NO_INDEX) {
        vec4 metallicRoughness = sampleTexture(metallicRoughnessTexture, s.uv0, s.uv1);
        m.metallic *= metallicRoughness.b;
        roughness *= metallicRoughness.g;
    }
    m.alpha = roughness * roughness;
    m.flags = materialFlags(s.material);
    // Without an interface there is none for the code of other materials to find.
    m.ior = (m.flags & MATERIAL_INTERFACE) != 0u ? materialIor(s.material) : 1.0;
    m.albedoTable = materialAlbedoTable(s.material);
    materialPointDefaults(m);
    m.emission = vec3(0);
    if ((m.flags & MATERIAL_EMISSIVE) != 0u) m.emission = emissionAt(s.material, materialEmissionTexture(s.material), s.uv0, s.uv1);
    m.transmission = 0.0;
    m.absorption = vec3(0);
    if (has(FEATURE_TRANSMISSION)) {
        m.transmission = materialTransmission(s.material);
        uint texture_ = materialTransmissionTexture(s.material);
        if (has(FEATURE_TEXTURES) && m.transmission > 0.0 && texture_ != NO_INDEX)
            m.transmission *= sampleTexture(texture_, s.uv0, s.uv1).r;
    }
    if (has(FEATURE_ATTENUATION)) m.absorption = materialAbsorption(s.material);
    readInterface(s, m);
    readOptionalLobes(s, m);
    return m;
}

bool isCutOut(uint flags) { return (flags & (MATERIAL_MASK | MATERIAL_BLEND)) != 0u; }

// Share of a cut-out surface that is there, at a point of it: what it emits and stops.
float coverageAt(uint material, uint flags, vec2 uv0, vec2 uv1, vec4 color) {
    float alpha = baseColorAndAlpha(material, materialBaseColorTexture(material), uv0, uv1, color).a;
    if ((flags & MATERIAL_MASK) != 0u) return alpha >= materialAlphaCutoff(material) ? 1.0 : 0.0;
    return clamp(alpha, 0.0, 1.0);
}

// Whether a ray stops at a cut-out surface. Blended surfaces stop a share α of the rays; the number
// that decides depends on the ray's key and the primitive alone, so traversal order does not matter.
bool acceptHit(uint primitive, vec2 barycentrics, uint key) {
    VertexIndices v = loadPrimitive(primitive);
    uint flags = materialFlags(v.material);
    vec3 b = vec3(1.0 - barycentrics.x - barycentrics.y, barycentrics);
    vec2 uv0 = vec2(0), uv1 = vec2(0);
    vec4 color = vec4(1);
    if (has(FEATURE_SHAPES) && v.a == NO_INDEX) {
        uv0 = uv1 = barycentrics;
    } else {
        if (VERTEX_TEXELS > 1u) loadTexCoords(v, b, interpolateTexel(v, b, 0u).w, uv0, uv1);
        color = loadColor(v, b);
    }
    if (!isCutOut(flags)) return true;
    float coverage = coverageAt(v.material, flags, uv0, uv1, color);
    if ((flags & MATERIAL_MASK) != 0u) return coverage > 0.0;
    uint bits = pcg4d(uvec4(key, primitive, 0x63757475u, 0x6f757421u)).x;
    return unitFloat(bits) < coverage;
}

#endif
