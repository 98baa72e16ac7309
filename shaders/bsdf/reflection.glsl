// Microfacet reflection with unit Fresnel reflectance; the caller multiplies by its Fresnel term.
#ifndef REFLECTION_GLSL
#define REFLECTION_GLSL

// The normal between two directions of one side, and the cosine of either with it: |wo + wi| / 2. wo · h would cancel
// between grazing directions that face each other, to 0 or below, and samples drawn there have no pdf.
vec3 reflectionHalfVector(vec3 wo, vec3 wi, out float cosTheta) {
    vec3 sum = wo + wi;
    float size = length(sum);
    cosTheta = 0.5 * size;
    return sum / size;
}

// BSDF times cosine, 1/sr, of the facets' density and visibility.
float reflectionEval(float density, float visibility, vec3 wo, vec3 wi) {
    return sameHemisphere(wo, wi) ? density * visibility * abs(wi.z) : 0.0;
}

// Solid-angle pdf of wi, 1/sr: facetPdf over 4 wo · h, without the cosines.
float reflectionPdf(Facets f, vec3 h, vec3 wo, vec3 wi) {
    float sum = abs(wo.z) + facetStretch(f, wo);
    float d = isStretched(f) ? ggxD(h, f.alpha) : ggxD(h, f.alpha.y);
    return sameHemisphere(wo, wi) && sum > 0.0 ? 0.5 * d / sum : 0.0;
}

vec3 reflectionSample(vec3 wo, vec3 h) { return 2.0 * dot(wo, h) * h - wo; }

#endif
