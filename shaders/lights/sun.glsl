// Directional lights with an angular size: a disk of even radiance, infinitely far, sampled uniformly by
// solid angle. All in terms of h = 1 − cos θmax, which keeps its digits however small the disk is.
// LightRecord: direction a, b.x = 1 − cos θmax.
#ifndef SUN_GLSL
#define SUN_GLSL

#include "light_sample.glsl"

// Solid-angle pdf, 1/sr.
float sunPdf(float h) { return 1.0 / (TWO_PI * h); }

// `towards` the middle of the disk.
vec3 sunSample(vec3 towards, float h, vec2 u) {
    float below = u.x * h;                         // 1 − cosθ
    float sinTheta = sqrt(below * (2.0 - below));
    float phi = TWO_PI * u.y;
    mat3 frame = frameAround(towards);
    return normalize(frame * vec3(sinTheta * cos(phi), sinTheta * sin(phi), 1.0 - below));
}

// Whether a direction meets the disk: by the chord, |d − t|² = 2 (1 − cosθ), since the cosine itself has lost it.
bool sunCovers(vec3 towards, float h, vec3 direction) {
    vec3 chord = direction - towards;
    return dot(chord, chord) <= 2.0 * h;
}

bool sampleSunLight(LightRecord light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    l.wi = sunSample(-light.a, light.b.x, unitFloat(bits.zw));
    l.radiance = lightValue(light);
    l.pdf = pmf * sunPdf(light.b.x);
    l.infinite = true;
    l.target = l.wi;
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    return true;
}

// Solid-angle pdf, 1/sr, with which a direction towards it is sampled.
float sunLightPdf(LightRecord light) { return sunPdf(light.b.x); }

// Whether a ray that leaves the scene meets it.
bool meetsSunLight(LightRecord light, vec3 direction) { return sunCovers(-light.a, light.b.x, direction); }

#endif
