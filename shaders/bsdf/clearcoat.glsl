// KHR_materials_clearcoat, above all other lobes: a clear layer of index 1.5 with the exact Fresnel term and a
// roughness and normal of its own; GGX, or Disney's GTR1. What lies below, emission included, is dimmed by
// 1 − clearcoat · E(wo), E the coat's directional albedo: on wo alone as glTF and OpenPBR have it, so that a
// white stack returns all light and the sum is not reciprocal though the coat is. Behind FEATURE_CLEARCOAT; a
// coat of weight 0 changes nothing.
#ifndef CLEARCOAT_GLSL
#define CLEARCOAT_GLSL

#include "gtr1.glsl"

const float kCoatIor = 1.5;

struct Coat {
    float weight;  // 0: none
    float alpha;   // microfacet α
    float albedo;  // E(wo)
    bool gtr1;
    mat3 frame;    // axes of the coat in the shading frame of the base
};

// A delta lobe: coatEval is then not asked, and coatSample gives the mirror direction.
bool coatIsMirror(Coat c) { return !c.gtr1 && c.alpha < ALPHA_DELTA; }

Coat coatAt(MaterialPoint m, vec3 wo) {
    Coat c;
    c.weight = m.clearcoat;
    c.gtr1 = has(FEATURE_GTR1) && (m.flags & MATERIAL_GTR1) != 0u;
    c.alpha = c.gtr1 ? gtr1Alpha(m.clearcoatAlpha) : m.clearcoatAlpha;
    c.frame = frameAround(m.clearcoatNormal);
    c.albedo = 0.0;
    // The table knows a mirror by an α of 0: at grazing angles those between have quite other albedos.
    float alpha = coatIsMirror(c) ? 0.0 : c.alpha;
    if (c.weight > 0.0) c.albedo = reflectionAlbedo(m.coatTable, dot(wo, m.clearcoatNormal), alpha);
    return c;
}

// Share of light from wo that the coat keeps from what lies below.
float coatAlbedo(Coat c, vec3 wo) { return c.weight * c.albedo; }

// Light that the base's shading normal puts below the surface has no way in.
bool coatReflects(vec3 o, vec3 i, vec3 wi) { return o.z > 0.0 && i.z > 0.0 && wi.z > 0.0; }

// BSDF times cosine, 1/sr, with the weight.
vec3 coatEval(Coat c, vec3 wo, vec3 wi) {
    vec3 o = wo * c.frame, i = wi * c.frame;
    if (!coatReflects(o, i, wi)) return vec3(0);
    float cosine;
    vec3 h = reflectionHalfVector(o, i, cosine);
    float f = c.weight * fresnelDielectric(cosine, kCoatIor) * i.z;
    if (c.gtr1) return vec3(f * gtr1D(h, c.alpha) * gtr1Visibility(o, i));
    return vec3(f * ggxD(h, c.alpha) * ggxVisibility(o, i, c.alpha));
}

// Solid-angle pdf of wi, 1/sr, as coatSample draws.
float coatPdf(Coat c, vec3 wo, vec3 wi) {
    vec3 o = wo * c.frame, i = wi * c.frame;
    if (!coatReflects(o, i, wi)) return 0.0;
    float cosine;
    vec3 h = reflectionHalfVector(o, i, cosine);
    if (c.gtr1) return gtr1D(h, c.alpha) * h.z / (4.0 * cosine);
    // ggxVisiblePdf over 4 o · h, whose cosines leave no rounding behind this way.
    return ggxD(h, c.alpha) / (2.0 * (o.z + ggxStretch(o, c.alpha)));
}

// False where no light goes. `colour`: for a mirror, its reflectance with the weight.
bool coatSample(Coat c, vec3 wo, vec2 u, out vec3 wi, out vec3 colour) {
    vec3 o = wo * c.frame;
    vec3 h = vec3(0, 0, 1);
    if (!coatIsMirror(c)) h = c.gtr1 ? gtr1SampleNormal(c.alpha, u) : ggxSampleVisible(o, c.alpha, u);
    float cosine = dot(o, h);
    vec3 i = 2.0 * cosine * h - o;
    wi = c.frame * i;
    colour = vec3(c.weight * fresnelDielectric(cosine, kCoatIor));
    return cosine > 0.0 && coatReflects(o, i, wi);
}

#endif
