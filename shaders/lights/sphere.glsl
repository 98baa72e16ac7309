// Spheres that emit, sampled uniformly in the cone that they fill. By h = 1 − cos θmax = sin² / (1 + cos), which keeps
// its digits for a small or far sphere (PBRT 4th ed., 6.2.4). A point within a sphere leaves it to the BSDF, which has
// the light all around.
// LightRecord: centre p, radius a.x.
#ifndef SPHERE_LIGHT_GLSL
#define SPHERE_LIGHT_GLSL

#include "light_sample.glsl"

struct SphereCone {
    vec3 towards;     // unit, the centre
    float distance;   // to it
    float sinSquared; // of the half angle
    float h;          // 1 − its cosine; 0 from within the sphere
};

SphereCone sphereCone(vec3 centre, float radius, vec3 from) {
    SphereCone c;
    vec3 d = centre - from;
    float squared = dot(d, d), radius2 = radius * radius;
    c.distance = sqrt(squared);
    c.h = 0.0;
    c.sinSquared = 1.0;
    c.towards = vec3(0, 0, 1);
    if (!(squared >= radius2) || squared == 0.0) return c;
    c.towards = d / c.distance;
    c.sinSquared = radius2 / squared;
    // (d + r)(d − r) rather than d² − r²: a point on the sphere has the whole hemisphere.
    float cosSquared = (c.distance + radius) * (c.distance - radius) / squared;
    c.h = c.sinSquared / (1.0 + sqrt(max(cosSquared, 0.0)));
    return c;
}

// Solid-angle pdf, 1/sr; 0 from within.
float spherePdf(SphereCone c) { return c.h > 0.0 ? 1.0 / (TWO_PI * c.h) : 0.0; }

// A direction in the cone, and the distance along it at which a ray to the sphere has to end so that it does not meet
// the sphere: its crossing comes from the intersection with an error of up to 8·2^-24·d·(1 + 1/√(1 − q)), where q is
// the squared distance of the line from the centre in radii (shaders/shapes/sphere.glsl).
vec3 sphereSample(SphereCone c, float radius, vec2 u, out float reach) {
    float below = u.x * c.h;                       // 1 − cosθ
    float sinSquared = below * (2.0 - below);
    float phi = TWO_PI * u.y;
    float q = min(sinSquared / c.sinSquared, 1.0), inner = sqrt(1.0 - q);
    // d cosθ − √(r² − d² sin²θ), as the product of the crossings over the farther one.
    float crossing = (c.distance + radius) * (c.distance - radius) / (c.distance * (1.0 - below) + radius * inner);
    float error = 16.0 * 5.9604645e-8 * c.distance;
    reach = crossing - min(error * (1.0 + 1.0 / max(inner, 1e-4)), max(0.1 * radius, 2.0 * error));
    float sinTheta = sqrt(sinSquared);
    return normalize(frameAround(c.towards) * vec3(sinTheta * cos(phi), sinTheta * sin(phi), 1.0 - below));
}

bool sampleSphereLight(LightRecord light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    SphereCone c = sphereCone(light.p, light.a.x, s.position);
    if (!(c.h > 0.0)) return false;
    float reach;
    l.wi = sphereSample(c, light.a.x, unitFloat(bits.zw), reach);
    l.radiance = lightValue(light);
    l.pdf = pmf * spherePdf(c);
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = s.position + max(reach, 0.0) * l.wi;
    l.infinite = false;
    return l.pdf > 0.0;
}

// Solid-angle pdf, 1/sr, with which a direction towards it is sampled.
float sphereLightPdf(LightRecord light, vec3 from) { return spherePdf(sphereCone(light.p, light.a.x, from)); }

#endif
