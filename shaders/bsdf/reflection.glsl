// Microfacet reflection with unit Fresnel reflectance; the caller multiplies by its Fresnel term.
#ifndef REFLECTION_GLSL
#define REFLECTION_GLSL

// BSDF times cosine, 1/sr.
float reflectionEval(Facets f, vec3 h, vec3 wo, vec3 wi) {
    if (!sameHemisphere(wo, wi) || !(dot(wo, h) > 0.0)) return 0.0;
    return facetD(f, h) * facetVisibility(f, wo, wi) * abs(wi.z);
}

// Solid-angle pdf of wi, 1/sr.
float reflectionPdf(Facets f, vec3 h, vec3 wo, vec3 wi) {
    if (!sameHemisphere(wo, wi)) return 0.0;
    float cosine = dot(wo, h);
    return cosine > 0.0 ? facetPdf(f, wo, h) / (4.0 * cosine) : 0.0;
}

// The same for isotropic GGX.
float reflectionEval(vec3 h, vec3 wo, vec3 wi, float alpha) {
    if (!sameHemisphere(wo, wi)) return 0.0;
    return ggxD(h, alpha) * ggxVisibility(wo, wi, alpha) * abs(wi.z);
}
float reflectionPdf(vec3 h, vec3 wo, vec3 wi, float alpha) {
    if (!sameHemisphere(wo, wi)) return 0.0;
    float cosine = abs(dot(wo, h));
    return cosine > 0.0 ? ggxVisiblePdf(wo, h, alpha) / (4.0 * cosine) : 0.0;
}

vec3 reflectionSample(vec3 wo, vec3 h) { return 2.0 * dot(wo, h) * h - wo; }

#endif
