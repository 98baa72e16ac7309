// The diffuse base: what it reflects (front) and lets through (back), each sampled by a cosine lobe.
#ifndef DIFFUSE_GLSL
#define DIFFUSE_GLSL

struct DiffuseBase {
    vec3 front;  // albedo, with the shares of dielectric and of transmission
    vec3 back;   // likewise of diffuse transmission; 0 without FEATURE_DIFFUSE_TRANSMISSION
};

DiffuseBase diffuseBaseAt(MaterialPoint m) {
    return DiffuseBase(m.baseColor * ((1.0 - m.metallic) * (1.0 - m.transmission)), vec3(0));
}

bool sameHemisphere(vec3 a, vec3 b) { return a.z * b.z > 0.0; }

// BSDF times cosine, 1/sr, of a base that lets through all light; both directions above the surface.
vec3 diffuseFrontEval(DiffuseBase base, vec3 wo, vec3 wi) { return base.front * (INV_PI * abs(wi.z)); }

// Likewise, wi below the surface.
vec3 diffuseBackEval(DiffuseBase base, vec3 wo, vec3 wi) { return base.back * (INV_PI * abs(wi.z)); }

// Solid-angle pdf, 1/sr, of cosineSample on the side asked.
float cosinePdf(vec3 wi) { return abs(wi.z) * INV_PI; }

#endif
