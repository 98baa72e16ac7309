// Parameters of the lobes that most materials lack, read only under their features.
#ifndef MATERIAL_LAYERS_GLSL
#define MATERIAL_LAYERS_GLSL

#include "bsdf/albedo_table.glsl"

uvec4 materialWords(uint material, uint texel) { return LOAD(materialTexels, material * MATERIAL_TEXELS + texel); }

vec4 textureOrOne(uint index, vec2 uv0, vec2 uv1) {
    return has(FEATURE_TEXTURES) && index != NO_INDEX ? sampleTexture(index, uv0, uv1) : vec4(1);
}

// x: weight, y: microfacet α.
vec2 clearcoatAt(uint material, vec2 uv0, vec2 uv1) {
    vec4 coat = materialTexel(material, 8u);
    if (!(coat.x > 0.0)) return vec2(0);
    float roughness = coat.y * textureOrOne(materialWords(material, 9u).x, uv0, uv1).g;
    return vec2(coat.x * textureOrOne(materialWords(material, 6u).w, uv0, uv1).r, roughness * roughness);
}

// What the coat lets through of emission that leaves at cosθ to the geometric normal. Light sampling and paths
// that meet the emitter use the same number, so that they agree.
float emissionThroughCoat(uint material, vec2 uv0, vec2 uv1, float cosTheta) {
    if (!has(FEATURE_CLEARCOAT)) return 1.0;
    vec2 coat = clearcoatAt(material, uv0, uv1);
    return coat.x > 0.0 ? 1.0 - coat.x * reflectionAlbedo(materialWords(material, 17u).y, cosTheta, coat.y) : 1.0;
}

void readClearcoat(Surface s, inout MaterialPoint m) {
    vec2 coat = clearcoatAt(s.material, s.uv0, s.uv1);
    m.clearcoat = coat.x;
    m.clearcoatAlpha = coat.y;
    m.clearcoatNormal = s.coatNormal * s.frame;
    m.coatTable = materialWords(s.material, 17u).y;
}

void readSheen(Surface s, inout MaterialPoint m) {
    vec4 sheen = materialTexel(s.material, 10u);
    if (!(maxComponent(sheen.rgb) > 0.0)) return;
    uvec4 textures = materialWords(s.material, 9u);
    m.sheenColor = sheen.rgb * textureOrOne(textures.z, s.uv0, s.uv1).rgb;
    m.sheenRoughness = sheen.a * textureOrOne(textures.w, s.uv0, s.uv1).a;
    m.sheenTable = materialWords(s.material, 17u).z;
}

void readDiffuseTransmission(Surface s, inout MaterialPoint m) {
    vec4 transmission = materialTexel(s.material, 14u);
    if (!(transmission.a > 0.0)) return;
    m.diffuseTransmission = transmission.a * textureOrOne(materialWords(s.material, 13u).w, s.uv0, s.uv1).a;
    m.diffuseTransmissionColor = transmission.rgb * textureOrOne(materialWords(s.material, 17u).x, s.uv0, s.uv1).rgb;
}

// The inside of a solid has neither coat nor sheen: they lie on its outer side.
void readLayers(Surface s, inout MaterialPoint m) {
    bool inside = !s.frontFace && (m.flags & MATERIAL_THIN) == 0u && (m.transmission > 0.0 || m.diffuseTransmission > 0.0);
    if (inside) return;
    if (has(FEATURE_CLEARCOAT)) readClearcoat(s, m);
    if (has(FEATURE_SHEEN)) readSheen(s, m);
    if (has(FEATURE_DISNEY_SHEEN)) {
        m.disneySheen = materialTexel(s.material, 15u).a;
        m.disneySheenTint = materialTexel(s.material, 16u).a;
    }
}

// After transmission, which decides what is a solid.
void readOptionalLobes(Surface s, inout MaterialPoint m) {
    if (has(FEATURE_DIFFUSE_TRANSMISSION)) readDiffuseTransmission(s, m);
    if (has(FEATURE_DISNEY_DIFFUSE)) m.subsurface = materialTexel(s.material, 11u).w;
    if (has(FEATURE_OREN_NAYAR)) m.orenNayarSigma = materialTexel(s.material, 4u).w;
    readLayers(s, m);
}

#endif
