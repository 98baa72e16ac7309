// Material parameters at a surface point: factors times textures times vertex colours.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL

#include "material_point.glsl"

vec4 materialTexel(uint material, uint texel) {
    return uintBitsToFloat(LOAD(materialTexels, material * MATERIAL_TEXELS + texel));
}

vec4 baseColorAndAlpha(uint material, uint baseColorTexture, vec2 uv0, vec2 uv1, vec4 color) {
    vec4 base = materialTexel(material, 0u) * color;
    if (has(FEATURE_TEXTURES) && baseColorTexture != NO_INDEX) base *= sampleTexture(baseColorTexture, uv0, uv1);
    return base;
}

vec3 emissionAt(uint material, uint emissionTexture, vec2 uv0, vec2 uv1) {
    vec3 emission = materialTexel(material, 1u).rgb;
    if (has(FEATURE_TEXTURES) && emissionTexture != NO_INDEX) emission *= sampleTexture(emissionTexture, uv0, uv1).rgb;
    return emission;
}

#include "material_interface.glsl"
#include "material_layers.glsl"

MaterialPoint materialAt(Surface s) {
    MaterialPoint m;
    uvec4 textures = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 5u);
    vec4 surface = materialTexel(s.material, 2u);
    uvec4 more = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 3u);

    m.baseColor = baseColorAndAlpha(s.material, textures.x, s.uv0, s.uv1, s.color).rgb;
    m.metallic = surface.x;
    float roughness = surface.y;
    if (has(FEATURE_TEXTURES) && textures.y != NO_INDEX) {
        vec4 metallicRoughness = sampleTexture(textures.y, s.uv0, s.uv1);
        m.metallic *= metallicRoughness.b;
        roughness *= metallicRoughness.g;
    }
    m.alpha = roughness * roughness;
    m.flags = more.y;
    // Without an interface there is none for the code of other materials to find.
    m.ior = (m.flags & MATERIAL_INTERFACE) != 0u ? surface.w : 1.0;
    m.albedoTable = more.z;
    materialPointDefaults(m);
    m.emission = vec3(0);
    if ((m.flags & MATERIAL_EMISSIVE) != 0u) m.emission = emissionAt(s.material, textures.w, s.uv0, s.uv1);
    m.transmission = 0.0;
    m.absorption = vec3(0);
    if (has(FEATURE_TRANSMISSION)) {
        m.transmission = uintBitsToFloat(more.x);
        uint texture_ = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 6u).x;
        if (has(FEATURE_TEXTURES) && m.transmission > 0.0 && texture_ != NO_INDEX)
            m.transmission *= sampleTexture(texture_, s.uv0, s.uv1).r;
    }
    if (has(FEATURE_ATTENUATION)) m.absorption = materialTexel(s.material, 4u).rgb;
    readInterface(s, uintBitsToFloat(more.w), m);
    readOptionalLobes(s, m);
    return m;
}

uint materialFlags(uint material) { return LOAD(materialTexels, material * MATERIAL_TEXELS + 3u).y; }

bool isCutOut(uint flags) { return (flags & (MATERIAL_MASK | MATERIAL_BLEND)) != 0u; }

// Share of a cut-out surface that is there, at a point of it: what it emits and stops.
float coverageAt(uint material, uint flags, vec2 uv0, vec2 uv1, vec4 color) {
    uint baseColorTexture = LOAD(materialTexels, material * MATERIAL_TEXELS + 5u).x;
    float alpha = baseColorAndAlpha(material, baseColorTexture, uv0, uv1, color).a;
    if ((flags & MATERIAL_MASK) != 0u) return alpha >= materialTexel(material, 1u).a ? 1.0 : 0.0;
    return clamp(alpha, 0.0, 1.0);
}

// Whether a ray stops at a cut-out surface. Blended surfaces stop a share α of the rays; the number
// that decides depends on the ray's key and the primitive alone, so traversal order does not matter.
bool acceptHit(uint primitive, vec2 barycentrics, uint key) {
    VertexIndices v = loadPrimitive(primitive);
    uint flags = LOAD(materialTexels, v.material * MATERIAL_TEXELS + 3u).y;
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
