// Next event estimation: light that arrives at a surface, or at a point in fog, straight from the lights.
#ifndef DIRECT_LIGHT_GLSL
#define DIRECT_LIGHT_GLSL

#include "direction.glsl"
#include "glass_shadow.glsl"
#include "light_paths.glsl"
#include "medium.glsl"
#include "path_state.glsl"

// The side on which a surface sees lights, for lightPmf; zero for both.
vec3 lightSide(Surface s, Bsdf bsdf) {
    return isFogPoint(s) || lightPasses(bsdf) ? vec3(0) : s.geometricNormal;
}

// What light comes through to a surface: what is on wo's side and behind it, and what a path makes of panes.
struct LightWay {
    Medium near, far;
    uint channel;  // of the path
    bool shadows;  // FEATURE_SHADOW_DEPTH: whether anything may be in the way
};

Medium mediumBehind(Medium near, Surface s, MaterialPoint m, Bsdf bsdf) {
    if (bsdf.face.thin) return near;
    if (mediaNest())
        return innermost(s.frontFace ? withMedium(near.stack, s.material) : withoutMedium(near.stack, s.material));
    return s.frontFace ? Medium(m.absorption, true, uvec4(NO_INDEX)) : outside();
}

LightWay lightWay(PathState path, Surface s, MaterialPoint m, Bsdf bsdf) {
    bool shadows = !has(FEATURE_SHADOW_DEPTH) || scatterings(path) < parameters.shadowDepth;
    return LightWay(path.medium, isFogPoint(s) ? path.medium : mediumBehind(path.medium, s, m, bsdf), path.channel, shadows);
}

// What is left of a light's sample behind the medium that it comes through.
vec3 shadowTransmittance(LightSample l, Medium medium) {
    vec3 left = vec3(1);
    if (has(FEATURE_ATTENUATION) && !l.infinite) left *= exp(-medium.absorption * distance(l.origin, l.target));
    if (hasFog(medium)) left *= fogTransmittance(l.origin, l.wi, l.infinite ? INFINITY : distance(l.origin, l.target));
    return left;
}

// BSDF times cosine towards wi in the shading frame, with the diffuse base's part in it, or the phase function.
vec3 scattered(Surface s, Bsdf bsdf, vec3 wo, vec3 wi, out float pdf, out vec3 diffuse) {
    if (!isFogPoint(s)) {
        vec3 f = bsdfEvalParts(bsdf, wo, wi, pdf, diffuse);
        if (has(FEATURE_DIRECTION_SAMPLING)) pdf = directionPdf(bsdf, wi, pdf);
        return f;
    }
    diffuse = vec3(0);
    pdf = phasePdf(fogAnisotropy(), -wo, wi);
    return vec3(pdf);
}

// What a sampled point of a light sends along the path, weighted against the BSDF's finding it. Its parts are added to
// `parts`.
vec3 lightThrough(LightSample l, SampleKey key, uint bounce, Surface s, Bsdf bsdf, vec3 wo, LightWay way,
                  inout FirstScattering parts) {
    vec3 wi = l.wi * s.frame;
    // Light must not leak through the surface that the shading normal only pretends to be.
    if (!isFogPoint(s) && dot(l.wi, s.geometricNormal) * wi.z <= 0.0) return vec3(0);
    if (lightsByBsdf() && l.pdf > 0.0) return vec3(0);
    float pdf;
    vec3 diffuse, f = scattered(s, bsdf, wo, wi, pdf, diffuse);
    if (!(maxComponent(f) > 0.0)) return vec3(0);
    float weight = lightsAlone() ? 1.0 : powerHeuristic(l.pdf, pdf);
    vec3 contribution = l.pdf > 0.0 ? f * l.radiance * (weight / l.pdf) : f * l.radiance;
    Medium medium = wi.z > 0.0 || isFogPoint(s) ? way.near : way.far;
    if (has(FEATURE_ATTENUATION) || has(FEATURE_FOG)) contribution *= shadowTransmittance(l, medium);
    if (!(maxComponent(contribution) > 0.0)) return vec3(0);
    if (has(FEATURE_GLASS_SHADOWS)) {
        if (way.shadows) contribution *= throughPanes(l, s, shadowKey(key, bounce), medium, way.channel);
        if (!(maxComponent(contribution) > 0.0)) return vec3(0);
    } else if (way.shadows && occluded(l, s, shadowKey(key, bounce))) {
        return vec3(0);
    }
    if (has(FEATURE_LIGHT_PATHS)) {
        if (isFogPoint(s))
            parts.volume += contribution;
        else if (wi.z < 0.0)
            parts.transmitted += contribution;
        else
            parts.diffuse += contribution * shareOf(diffuse, f);
    }
    return contribution;
}

// Light that arrives straight from the lights; `parts`: of the surface's lobes in it.
vec3 directLight(SampleKey key, uint bounce, Surface s, Bsdf bsdf, vec3 wo, LightWay way, out FirstScattering parts) {
    parts = noScattering();
    // Of the kinds of lights only those without extent are left to this.
    if (lightsByBsdf() && !has(FEATURE_PUNCTUAL_LIGHTS)) return vec3(0);
    vec3 sum = vec3(0);
    uint samples = lightsAll() ? parameters.lightGroups : 1u;
    for (uint i = 0u; i < samples; i++) {
        LightSample l;
        bool found = lightsAll() ? sampleGroup(i, key, bounce, s, l) : sampleLight(key, bounce, s, lightSide(s, bsdf), l);
        if (found) sum += lightThrough(l, key, bounce, s, bsdf, wo, way, parts);
    }
    return sum;
}

#endif
