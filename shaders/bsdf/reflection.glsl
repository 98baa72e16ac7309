// Microfacet reflection with unit Fresnel reflectance; the caller multiplies by its Fresnel term.
#ifndef REFLECTION_GLSL
#define REFLECTION_GLSL

// BSDF times cosine, 1/sr.
float reflectionEval(vec3 h, vec3 wo, vec3 wi, float alpha) {
    if (!sameHemisphere(wo, wi)) return 0.0;
    return ggxD(h, alpha) * ggxVisibility(wo, wi, alpha) * abs(wi.z);
}

// Solid-angle pdf of wi, 1/sr.
float reflectionPdf(vec3 h, vec3 wo, vec3 wi, float alpha) {
    if (!sameHemisphere(wo, wi)) return 0.0;
    float cosine = abs(dot(wo, h));
    return cosine > 0.0 ? ggxVisiblePdf(wo, h, alpha) / (4.0 * cosine) : 0.0;
}

vec3 reflectionSample(vec3 wo, vec3 h) { return 2.0 * dot(wo, h) * h - wo; }

#endif
