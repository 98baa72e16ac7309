// The diffuse base: what it reflects (front) and lets through (back), each sampled by a cosine lobe.
//
// Back is KHR_materials_diffuse_transmission: a share of the diffuse light leaves on the far side, Lambertian,
// in a colour of its own: (1 − factor) · reflection + factor · colour / π into the other hemisphere. Without
// refraction, so radiance is not compressed. Front is Lambert's, Oren-Nayar's or Burley's.
#ifndef DIFFUSE_GLSL
#define DIFFUSE_GLSL

#include "disney_diffuse.glsl"
#include "oren_nayar.glsl"

struct DiffuseBase {
    vec3 front;  // albedo, with the shares of dielectric and of transmission
    vec3 back;   // likewise of diffuse transmission; 0 without FEATURE_DIFFUSE_TRANSMISSION
    vec3 color;       // albedo alone
    float sigma;      // Oren-Nayar's; 0: none
    bool disney;      // Burley's instead
    float roughness;  // perceptual
    float subsurface;
};

DiffuseBase diffuseBaseAt(MaterialPoint m) {
    DiffuseBase base;
    base.front = m.baseColor * ((1.0 - m.metallic) * (1.0 - m.transmission));
    base.back = vec3(0);
    if (has(FEATURE_DIFFUSE_TRANSMISSION) && m.diffuseTransmission > 0.0) {
        base.front *= 1.0 - m.diffuseTransmission;
        base.back = m.diffuseTransmissionColor * ((1.0 - m.metallic) * (1.0 - m.transmission) * m.diffuseTransmission);
    }
    base.color = m.baseColor;
    base.disney = has(FEATURE_DISNEY_DIFFUSE) && (m.flags & MATERIAL_DISNEY_DIFFUSE) != 0u;
    base.sigma = has(FEATURE_OREN_NAYAR) && !base.disney ? m.orenNayarSigma : 0.0;
    base.roughness = sqrt(m.alpha);
    base.subsurface = m.subsurface;
    return base;
}

bool sameHemisphere(vec3 a, vec3 b) { return a.z * b.z > 0.0; }

// BSDF times cosine, 1/sr, of a base that lets through all light; both directions above the surface.
vec3 diffuseFrontEval(DiffuseBase base, vec3 wo, vec3 wi) {
    vec3 f = base.front * (INV_PI * abs(wi.z));
    if (has(FEATURE_DISNEY_DIFFUSE) && base.disney) f *= disneyDiffuseShape(base.roughness, base.subsurface, wo, wi);
    if (has(FEATURE_OREN_NAYAR) && base.sigma > 0.0) f *= orenNayarShape(base.color, base.sigma, wo, wi);
    return f;
}

// Likewise, wi below the surface.
vec3 diffuseBackEval(DiffuseBase base, vec3 wo, vec3 wi) { return base.back * (INV_PI * abs(wi.z)); }

// Solid-angle pdf, 1/sr, of cosineSample on the side asked.
float cosinePdf(vec3 wi) { return abs(wi.z) * INV_PI; }

#endif
