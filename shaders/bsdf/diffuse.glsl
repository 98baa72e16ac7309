// Lambertian reflection.
#ifndef DIFFUSE_GLSL
#define DIFFUSE_GLSL

bool sameHemisphere(vec3 a, vec3 b) { return a.z * b.z > 0.0; }

// BSDF times cosine, 1/sr.
vec3 diffuseEval(vec3 albedo, vec3 wo, vec3 wi) {
    return sameHemisphere(wo, wi) ? albedo * (INV_PI * abs(wi.z)) : vec3(0);
}

// Solid-angle pdf, 1/sr.
float diffusePdf(vec3 wo, vec3 wi) { return sameHemisphere(wo, wi) ? abs(wi.z) * INV_PI : 0.0; }

vec3 diffuseSample(vec3 wo, vec2 u) {
    vec3 wi = cosineHemisphere(u);
    return wo.z < 0.0 ? -wi : wi;
}

#endif
