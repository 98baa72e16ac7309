// Warps of the unit square, and weights that combine sampling strategies.
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

#include "precise.glsl"

#define INFINITY uintBitsToFloat(0x7f800000u)
const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;
const float TWO_PI = 6.28318530717959;

float luminance(vec3 c) { return preciseDot(c, vec3(0.2126, 0.7152, 0.0722)); }
float maxComponent(vec3 c) { return max(c.x, max(c.y, c.z)); }
bool isFinite(vec3 v) { return !(any(isnan(v)) || any(isinf(v))); }

// Malley's method: a uniform point of the disk, lifted. pdf = cosθ / π.
vec3 cosineHemisphere(vec2 u) {
    float r = sqrt(u.x);
    float phi = TWO_PI * u.y;
    return vec3(r * cos(phi), r * sin(phi), sqrt(max(0.0, 1.0 - u.x)));
}

// pdf = 1 / 4π.
vec3 uniformSphere(vec2 u) {
    float z = 1.0 - 2.0 * u.x;
    float r = sqrt(max(0.0, 1.0 - z * z));
    return vec3(r * cos(TWO_PI * u.y), r * sin(TWO_PI * u.y), z);
}

// Uniform barycentrics (Heitz 2019: low distortion, no square root).
vec2 uniformTriangle(vec2 u) {
    float a, b;
    if (u.y > u.x) {
        a = 0.5 * u.x;
        b = u.y - a;
    } else {
        b = 0.5 * u.y;
        a = u.x - b;
    }
    return vec2(a, b);
}

// Power heuristic with β = 2 as a function of the ratio, so that no square overflows. An infinite pdf
// (delta) wins; a pdf of zero weighs nothing.
float powerHeuristic(float pdf, float other) {
    if (!(pdf > 0.0)) return 0.0;
    float ratio = other / pdf;
    return 1.0 / (1.0 + ratio * ratio);
}

// Index of the alias table that 32 random bits choose: floor(bits · n / 2^32).
uint scaledIndex(uint bits, uint n) {
    uint high, low;
    umulExtended(bits, n, high, low);
    return high;
}

// Orthonormal basis around a unit normal (Duff et al., JCGT 2017). Continuous but for the sign of z,
// where the copysign keeps it exact at n.z = ±0 and −1.
mat3 frameAround(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

#endif
