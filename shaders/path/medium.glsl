// What lies between the surfaces: inside a transmissive solid what absorbs there, outside fog, a homogeneous medium that
// absorbs and scatters, within a box.
//
// Where a path scatters in fog is drawn from the scattering coefficient alone; absorption is a weight, so that a medium
// that only absorbs brings no noise. Coefficients differ between channels: one is chosen by the path's throughput and
// draws the distance, and the weight is over the density that all have together (spectral MIS; Wilkie et al. 2014,
// pbrt-v4 14.1), which never lets the sum of the throughput grow.
#ifndef MEDIUM_GLSL
#define MEDIUM_GLSL

#include "../phase.glsl"
#include "media_stack.glsl"

struct Medium {
    vec3 absorption;  // of a solid, 1/m
    bool solid;       // no fog in here
    uvec4 stack;      // with FEATURE_NESTED_MEDIA
};

Medium outside() { return Medium(vec3(0), false, uvec4(NO_INDEX)); }

Medium innermost(uvec4 stack) {
    bool solid = stack.x != NO_INDEX;
    return Medium(solid ? materialAbsorption(stack.x) : vec3(0), solid, stack);
}

#define fogAnisotropy() (parameters.fogAnisotropy)
// By data as well: a kernel may hold fog's code for a scene without it.
bool hasFog(Medium medium) { return has(FEATURE_FOG) && parameters.fogPresent > 0.0 && !medium.solid; }

// Points in fog take part in what surfaces do as a Surface without a normal: it sees lights on all sides, rays leave it
// where it is, and no primitive is skipped.
Surface fogPoint(vec3 position) {
    Surface s;
    s.position = position;
    s.positionError = vec3(0);
    s.geometricNormal = vec3(0);
    s.frame = mat3(1);
    s.primitive = kNoPrimitive;
    s.frontFace = true;
    s.coincides = false;
    return s;
}
bool isFogPoint(Surface s) { return has(FEATURE_FOG) && s.primitive == kNoPrimitive; }

// The part of a ray's [0, tMax] within the fog's box; (0, 0) if there is none.
vec2 fogSpan(vec3 origin, vec3 direction, float tMax) {
    vec2 span = vec2(0, tMax);
    vec3 lower = parameters.fogLower - origin, upper = parameters.fogUpper - origin;
    for (int axis = 0; axis < 3; axis++) {
        if (abs(direction[axis]) < 1e-37) {  // denormals count as 0, which must not divide 0
            if (lower[axis] > 0.0 || upper[axis] < 0.0) return vec2(0);
            continue;
        }
        float a = lower[axis] / direction[axis], b = upper[axis] / direction[axis];
        span = vec2(max(span.x, min(a, b)), min(span.y, max(a, b)));
    }
    return span.x < span.y ? span : vec2(0);
}

// What is left of light after a straight way through the fog.
vec3 fogTransmittance(vec3 origin, vec3 direction, float tMax) {
    vec2 span = fogSpan(origin, direction, tMax);
    return exp(-(parameters.fogScattering + parameters.fogAbsorption) * (span.y - span.x));
}

// −ln(1 − u) from 56 random bits: fine steps at both ends, so that neither thin fog nor what passes thick fog is cut to
// multiples of 2^-32. Below ln 2 by the series of 2 atanh(u / (2 − u)), relative error 1e-7, since log loses digits near 1.
float exponential(uvec2 bits) {
    float u = (float(bits.x & 0x7fffffffu) + unitFloat(bits.y)) * (1.0 / 4294967296.0);
    if (bits.x >= 0x80000000u) return -log(max(u, 1e-18));
    float z = u / (2.0 - u), z2 = z * z;
    return 2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (1.0 / 5.0 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 * (1.0 / 11.0 + z2 * (1.0 / 13.0)))))));
}

// A ray's way through fog if no surface ends it.
struct FogFlight {
    vec2 span;      // of the ray, in fog
    float depth;    // in fog where it would scatter
    float reach;    // along the ray, likewise; INFINITY: not before the fog's end
    vec3 chances;   // of the channels' drawing it
    uint channel;   // that drew it
};

FogFlight fogFlight(vec3 throughput, Medium medium, Ray ray, SampleKey key, uint bounce) {
    FogFlight f = FogFlight(vec2(0), 0.0, INFINITY, vec3(0), 0u);
    if (!hasFog(medium)) return f;
    f.span = fogSpan(ray.origin, ray.direction, INFINITY);
    if (!(f.span.y > f.span.x)) return f;
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_FOG));
    // Any chances but 0 will do where a quotient of denormals might be NaN.
    float sum = throughput.x + throughput.y + throughput.z;
    f.chances = sum > 1e-30 ? throughput / sum : vec3(1.0 / 3.0);
    // What rounding leaves beyond the sum must not choose a channel of chance 0.
    float u = unitFloat(bits.z);
    f.channel = u < f.chances.x ? 0u : u < f.chances.x + f.chances.y || !(f.chances.z > 0.0) ? 1u : 2u;
    float rate = parameters.fogScattering[f.channel];
    if (!(rate > 0.0)) return f;
    f.depth = exponential(bits.xy) / rate;
    if (f.depth < f.span.y - f.span.x) f.reach = f.span.x + f.depth;
    return f;
}

// Weight of a way of `depth` through fog, scattering at its end or not. The chosen channel's density is divided out, whose
// exponent is at most 42; so nothing overflows and the sum is not 0.
vec3 fogWeight(FogFlight f, float depth, bool scatters) {
    if (!(depth > 0.0) && !scatters) return vec3(1);
    vec3 scattering = parameters.fogScattering;
    vec3 density = exp((scattering[f.channel] - scattering) * depth);
    if (scatters) density *= scattering;
    return density * exp(-parameters.fogAbsorption * depth) / dot(f.chances, density);
}

// Takes the throughput along a ray that meets a surface at t (INFINITY: none). True: it scatters in fog before that.
bool passFog(inout vec3 throughput, FogFlight f, float t) {
    bool scatters = f.reach < t;
    if (f.span.y > f.span.x)
        throughput *= fogWeight(f, scatters ? f.depth : max(min(t, f.span.y) - f.span.x, 0.0), scatters);
    return scatters;
}

#endif
