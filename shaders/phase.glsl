// Henyey and Greenstein's phase function (1941): p = (1 − g²) / (4π (1 + g² − 2 g cosθ)^(3/2)), θ between the directions
// before and after. It is normalised and sampled exactly, so the weight of a sample is 1.
//
// All in terms of h = 1 − cosθ around the axis that light prefers, forwards or (g < 0) backwards, and of |g|: then the
// denominator is (1 − |g|)² + 2 |g| h, a sum of what is positive, and keeps its digits as |g| → 1; nothing is divided by g.
#ifndef PHASE_GLSL
#define PHASE_GLSL

#include "sampling.glsl"

// Density at a given h, 1/sr.
float phaseDensity(float strength, float h) {
    float a = 1.0 - strength;
    float d = a * a + 2.0 * strength * h;
    return 0.25 * INV_PI * a * (1.0 + strength) / (d * sqrt(d));
}

vec3 phaseAxis(float g, vec3 direction) { return g < 0.0 ? -direction : direction; }

// Solid-angle density of going on towards `wi` from travelling along `direction`, 1/sr; at once value and pdf.
// Relative error ≤ 1 % up to |g| = 0.9999, by the directions' own rounding there. The chord gives h all its digits.
float phasePdf(float g, vec3 direction, vec3 wi) {
    vec3 chord = wi - phaseAxis(g, direction);
    return phaseDensity(abs(g), 0.5 * dot(chord, chord));
}

// The inverse of the distribution of cosθ, written for 1 − cosθ and 1 + cosθ without a difference:
//   1 − cosθ = 2 (1 − g)² v (1 + g w) / D²,  1 + cosθ = 2 (1 + g)² w (1 − g v) / D²,  w = 1 − v,  D = 1 − g + 2 g w.
vec3 phaseSample(float g, vec3 direction, vec2 u, out float pdf) {
    float strength = abs(g), a = 1.0 - strength, b = 1.0 + strength;
    float v = u.x, w = 1.0 - u.x;  // exact: multiples of 2^-24
    float d = a + 2.0 * strength * w;
    float h = 2.0 * (a / d) * (a / d) * v * (1.0 + strength * w);
    float above = 2.0 * (b / d) * (b / d) * w * (1.0 - strength * v);
    float sinTheta = sqrt(h * above), phi = TWO_PI * u.y;
    mat3 frame = frameAround(phaseAxis(g, direction));
    pdf = phaseDensity(strength, h);
    return normalize(frame * vec3(sinTheta * cos(phi), sinTheta * sin(phi), 1.0 - h));
}

#endif
