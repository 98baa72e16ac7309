// What a material is at one point of a surface, textures applied. Members after the first group are set
// only where a feature asks for them; materialPointDefaults gives them values without effect.
#ifndef MATERIAL_POINT_GLSL
#define MATERIAL_POINT_GLSL

#include "gpu_material_point.glsl"

struct MaterialPoint {
    vec3 baseColor;
    vec3 emission;
    float metallic;
    float alpha;  // microfacet α: perceptual roughness squared
    float ior;
    float transmission;
    vec3 absorption;
    uint flags;
    uint albedoTable;

    vec3 specularColor;  // FEATURE_SPECULAR_COLOR: of the dielectric's reflection at normal incidence
    float specular;      // and its strength
    float alphaT;        // FEATURE_ANISOTROPY: α along the tangent; `alpha` is across it
    vec3 conductorEta, conductorK;
    float iridescence, iridescenceIor, iridescenceThickness;  // nm

    float clearcoat, clearcoatAlpha;
    uint coatTable, sheenTable;
    vec3 clearcoatNormal;  // in the shading frame
    vec3 sheenColor;
    float sheenRoughness;  // perceptual
    float diffuseTransmission;
    vec3 diffuseTransmissionColor;
    MATERIAL_POINT_PARAMETERS
};

// KHR_materials_dispersion: the index for a colour channel; that of red and blue is half the spread less or more, within
// what glTF allows an index to be. Its 0, which is no index, stays. worker/render/interface_packer.cpp has the same.
float dispersedIor(float ior, float dispersion, uint channel) {
    if (ior == 0.0 || channel == 1u) return ior;
    return clamp(ior + (float(channel) - 1.0) * (ior - 1.0) * 0.025 * dispersion, 1.0, 1000.0);
}

// The same material in that channel: the albedo tables of red lie before those of green, those of blue after.
void setChannel(inout MaterialPoint m, uint channel) {
    m.ior = dispersedIor(m.ior, m.dispersion, channel);
    if (m.albedoTable != NO_INDEX) m.albedoTable += (channel - 1u) * 3u;
}

void materialPointDefaults(inout MaterialPoint m) {
    m.specularColor = vec3(1);
    m.specular = 1.0;
    m.alphaT = m.alpha;
    m.conductorEta = vec3(1);
    m.conductorK = vec3(0);
    m.iridescence = 0.0;
    m.iridescenceIor = 1.3;
    m.iridescenceThickness = 0.0;
    m.clearcoat = m.clearcoatAlpha = 0.0;
    m.coatTable = m.sheenTable = 0u;
    m.clearcoatNormal = vec3(0, 0, 1);
    m.sheenColor = vec3(0);
    m.sheenRoughness = 0.0;
    m.diffuseTransmission = 0.0;
    m.diffuseTransmissionColor = vec3(1);
    MATERIAL_POINT_DEFAULTS(m)
}

#endif
