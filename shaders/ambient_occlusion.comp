#version 460
// Share of the hemisphere above the first surface, weighted by the cosine, that nothing hides within a distance.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#include "kernel.glsl"
#include "integrators/first_surface.glsl"

bool open(SampleKey key, Surface s) {
    vec3 wi = s.frame * cosineHemisphere(unitFloat(randomBits(key, bounceDimension(0u, DIMENSION_BSDF)).yz));
    // Below the surface that the shading normal only pretends to be there is nothing to see.
    if (dot(wi, s.geometricNormal) <= 0.0) return false;
    vec3 origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, wi);
    rayCount++;
    Ray ray = freeRay(origin, wi, parameters.occlusionDistance, cutoutKey(key, 1u));
    startOn(s, ray);
    ray.culls = cullsAll();
    return !anyHit(ray);
}

PathSample traceSample(SampleKey key, vec3 origin, vec3 direction) {
    Hit hit;
    Surface s;
    if (!firstSurface(key, origin, direction, hit, s)) return nothingSeen();
    return seenAs(vec3(open(key, s) ? 1.0 : 0.0), s, materialAt(s), hit.t);
}

#include "sample_loop.glsl"
