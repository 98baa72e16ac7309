// Parameters of the lobes that most materials lack, read only under their features.
#ifndef MATERIAL_LAYERS_GLSL
#define MATERIAL_LAYERS_GLSL

#include "bsdf/albedo_table.glsl"

vec4 textureOrOne(uint index, vec2 uv0, vec2 uv1) {
    return has(FEATURE_TEXTURES) && index != NO_INDEX ? sampleTexture(index, uv0, uv1) : vec4(1);
}

// x: weight, y: microfacet α.
vec2 clearcoatAt(uint material, vec2 uv0, vec2 uv1) {
    float coat = materialClearcoat(material);
    if (!(coat > 0.0)) return vec2(0);
    float roughness = materialClearcoatRoughness(material) *
                      textureOrOne(materialClearcoatRoughnessTexture(material), uv0, uv1).g;
    return vec2(coat * textureOrOne(materialClearcoatTexture(material), uv0, uv1).r, roughness * roughness);
}

// What the coat lets through of emission that leaves at cosθ to the geometric normal. Light sampling and paths
// that meet the emitter use the same number, so that they agree.
float emissionThroughCoat(uint material, vec2 uv0, vec2 uv1, float cosTheta) {
    if (!has(FEATURE_CLEARCOAT)) return 1.0;
    vec2 coat = clearcoatAt(material, uv0, uv1);
    return coat.x > 0.0 ? 1.0 - coat.x * reflectionAlbedo(materialCoatTable(material), cosTheta, coat.y) : 1.0;
}

void readClearcoat(Surface s, inout MaterialPoint m) {
    vec2 coat = clearcoatAt(s.material, s.uv0, s.uv1);
    m.clearcoat = coat.x;
    m.clearcoatAlpha = coat.y;
    m.clearcoatNormal = s.coatNormal * s.frame;
    m.coatTable = materialCoatTable(s.material);
}

void readSheen(Surface s, inout MaterialPoint m) {
    vec3 color = materialSheenColor(s.material);
    if (!(maxComponent(color) > 0.0)) return;
    m.sheenColor = color * textureOrOne(materialSheenColorTexture(s.material), s.uv0, s.uv1).rgb;
    m.sheenRoughness = materialSheenRoughness(s.material) *
                       textureOrOne(materialSheenRoughnessTexture(s.material), s.uv0, s.uv1).a;
    m.sheenTable = materialSheenTable(s.material);
}

void readDiffuseTransmission(Surface s, inout MaterialPoint m) {
    float share = materialDiffuseTransmission(s.material);
    if (!(share > 0.0)) return;
    m.diffuseTransmission = share * textureOrOne(materialDiffuseTransmissionTexture(s.material), s.uv0, s.uv1).a;
    m.diffuseTransmissionColor =
        materialDiffuseTransmissionColor(s.material) *
        textureOrOne(materialDiffuseTransmissionColorTexture(s.material), s.uv0, s.uv1).rgb;
}

// The inside of a solid has neither coat nor sheen: they lie on its outer side.
void readLayers(Surface s, inout MaterialPoint m) {
    bool inside = !s.frontFace && (m.flags & MATERIAL_THIN) == 0u && (m.transmission > 0.0 || m.diffuseTransmission > 0.0);
    if (inside) return;
    if (has(FEATURE_CLEARCOAT)) readClearcoat(s, m);
    if (has(FEATURE_SHEEN)) readSheen(s, m);
    READ_MATERIAL_OUTSIDE(m, s.material)
}

// After transmission, which decides what is a solid.
void readOptionalLobes(Surface s, inout MaterialPoint m) {
    if (has(FEATURE_DIFFUSE_TRANSMISSION)) readDiffuseTransmission(s, m);
    READ_MATERIAL_BASE(m, s.material)
    readLayers(s, m);
}

#endif
