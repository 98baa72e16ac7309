// Microfacet transmission (Walter et al. 2007) with unit transmittance; the caller multiplies by its
// 1 − F. `eta` is the index of the far side over that of wo's side. Radiance is compressed by 1/eta².
#ifndef TRANSMISSION_GLSL
#define TRANSMISSION_GLSL

// A pair of directions as a facet refracts one into the other. All of it comes from the sum of the direction in front
// and `ior` times that behind, whichever is wo, so that light that goes back meets the same digits.
struct Refraction {
    vec3 h;            // the facet's normal, on the side of +z
    float cosO, cosI;  // of wo and wi with h
    float solidAngle;  // of wi per solid angle of h
    bool possible;
};

// `ior`: of what lies behind the surface over what lies in front; `inside`: wo is behind.
Refraction refractionAt(vec3 wo, vec3 wi, float ior, bool inside) {
    vec3 sum = inside ? wi + ior * wo : wo + ior * wi;
    float squared = dot(sum, sum);
    Refraction r = Refraction(vec3(0), 0.0, 0.0, 0.0, false);
    if (!(squared > 0.0)) return r;
    r.h = sum * (sum.z < 0.0 ? -inversesqrt(squared) : inversesqrt(squared));
    r.cosO = dot(wo, r.h);
    r.cosI = dot(wi, r.h);
    // |wi·h| / (wi·h + wo·h / eta)², whose terms would cancel for an index near 1.
    r.solidAngle = abs(r.cosI) * (inside ? 1.0 : ior * ior) / squared;
    r.possible = !sameHemisphere(wo, wi) && r.cosO > 0.0 && r.cosI < 0.0;
    return r;
}

// BSDF times cosine, 1/sr, of the facets' density and visibility.
float transmissionEval(Refraction r, float density, float visibility, vec3 wi, float eta) {
    float cosine = 4.0 * r.cosO * visibility * abs(wi.z);
    return density * cosine * r.solidAngle / (eta * eta);
}

// Solid-angle pdf of wi, 1/sr.
float transmissionPdf(Facets f, Refraction r, vec3 wo) { return facetPdf(f, wo, r.h) * r.solidAngle; }

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
