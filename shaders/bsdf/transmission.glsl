// Microfacet transmission (Walter et al. 2007) with unit transmittance; the caller multiplies by its
// 1 − F. `eta` is the index of the far side over that of wo's side. Radiance is compressed by 1/eta².
#ifndef TRANSMISSION_GLSL
#define TRANSMISSION_GLSL

// Half vector of a refracted pair on the side of +z; zero where there is none.
vec3 refractionHalfVector(vec3 wo, vec3 wi, float eta) {
    vec3 h = wo + eta * wi;
    float squared = dot(h, h);
    if (!(squared > 0.0)) return vec3(0);
    h *= inversesqrt(squared);
    return h.z < 0.0 ? -h : h;
}

// Solid angle of wi per solid angle of h.
float refractionJacobian(vec3 h, vec3 wo, vec3 wi, float eta) {
    float sum = dot(wi, h) + dot(wo, h) / eta;
    return abs(dot(wi, h)) / max(sum * sum, 1e-30);
}

bool refractionPossible(vec3 h, vec3 wo, vec3 wi) {
    return !sameHemisphere(wo, wi) && dot(wo, h) > 0.0 && dot(wi, h) < 0.0;
}

// BSDF times cosine, 1/sr.
float transmissionEval(Facets f, vec3 h, vec3 wo, vec3 wi, float eta) {
    if (!refractionPossible(h, wo, wi)) return 0.0;
    float cosine = 4.0 * dot(wo, h) * facetVisibility(f, wo, wi) * abs(wi.z);
    return facetD(f, h) * cosine * refractionJacobian(h, wo, wi, eta) / (eta * eta);
}

// Solid-angle pdf of wi, 1/sr.
float transmissionPdf(Facets f, vec3 h, vec3 wo, vec3 wi, float eta) {
    if (!refractionPossible(h, wo, wi)) return 0.0;
    return facetPdf(f, wo, h) * refractionJacobian(h, wo, wi, eta);
}

// Refracts wo at h; false beyond the critical angle.
bool transmissionSample(vec3 wo, vec3 h, float eta, out vec3 wi) {
    float cosI = dot(wo, h);
    float sinSquaredT = max(0.0, (1.0 - cosI) * (1.0 + cosI)) / (eta * eta);
    float cosSquaredT = 1.0 - sinSquaredT;
    wi = vec3(0);
    if (cosSquaredT <= 0.0) return false;
    wi = -wo / eta + (cosI / eta - sqrt(cosSquaredT)) * h;
    return wi.z * wo.z < 0.0;
}

#endif
