// Cruder ways to draw a path's next direction than by the BSDF, to show what importance sampling is worth: by the cosine,
// or uniform over the sphere. Mirrors have one direction only and keep it. Behind FEATURE_DIRECTION_SAMPLING.
#ifndef DIRECTION_GLSL
#define DIRECTION_GLSL

bool lightPasses(Bsdf b) {
    return transmits(b.face) || (has(FEATURE_DIFFUSE_TRANSMISSION) && maxComponent(b.diffuse.back) > 0.0);
}

// Probability that bsdfSample draws from a lobe that is not a mirror.
float roughChance(Bsdf b) {
    float mirrors = has(FEATURE_SPECULAR) && b.mirror ? b.facetChance : 0.0;
    if (has(FEATURE_CLEARCOAT) && coatIsMirror(b.coat)) mirrors += b.coatChance;
    return max(1.0 - mirrors, 0.0);
}

// pdf of wi, 1/sr, as sampleDirection draws; `ofBsdf` is bsdfSample's.
float directionPdf(Bsdf b, vec3 wi, float ofBsdf) {
    if (parameters.directionSampling == DIRECTION_BSDF) return ofBsdf;
    if (parameters.directionSampling == DIRECTION_UNIFORM) return roughChance(b) * (0.25 * INV_PI);
    if (lightPasses(b)) return roughChance(b) * (0.5 * INV_PI) * abs(wi.z);
    return wi.z > 0.0 ? roughChance(b) * INV_PI * wi.z : 0.0;
}

vec3 crudeDirection(Bsdf b, vec2 u) {
    if (parameters.directionSampling == DIRECTION_UNIFORM) return uniformSphere(u);
    if (!lightPasses(b)) return cosineHemisphere(u);
    bool below = u.x < 0.5;
    vec3 w = cosineHemisphere(vec2(2.0 * u.x - (below ? 0.0 : 1.0), u.y));
    return below ? mirrored(w) : w;
}

// Whether bsdfSample takes a mirror for this number: coat, then rough lobes, then facets.
bool picksMirror(Bsdf b, float pick) {
    if (has(FEATURE_CLEARCOAT) && coatIsMirror(b.coat) && pick < b.coatChance) return true;
    return has(FEATURE_SPECULAR) && b.mirror && b.facetChance > 0.0 && pick >= 1.0 - b.facetChance;
}

// False for a sample that carries nothing.
bool sampleDirection(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
    if (!has(FEATURE_DIRECTION_SAMPLING)) return bsdfSample(b, wo, u, s);
    bool crude = parameters.directionSampling != DIRECTION_BSDF;
    if (!crude || picksMirror(b, u.x)) return bsdfSample(b, wo, u, s) && (!crude || s.delta);
    s.delta = s.blocked = false;
    s.wi = crudeDirection(b, u.yz);
    s.pdf = directionPdf(b, s.wi, 0.0);
    float unused;
    s.weight = s.pdf > 0.0 ? bsdfEval(b, wo, s.wi, unused) / s.pdf : vec3(0);
    return s.pdf > 0.0;
}

#endif
