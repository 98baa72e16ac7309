// What probe.comp is asked to do; included by both sides.
#ifndef NUMERICS_PROBE_H
#define NUMERICS_PROBE_H

#ifdef __cplusplus
#include <cstdint>
#define PROBE_CONSTANT inline constexpr uint32_t
#else
#define PROBE_CONSTANT const uint
#endif

// unitFloat of the bits i · 256 + 255; counters: how many left [0, 1), bits of the largest.
PROBE_CONSTANT PROBE_UNIT_FLOATS = 0;
// frameAround(query.xyz): answers 3 columns.
PROBE_CONSTANT PROBE_FRAMES = 1;
// query 0: bits of (triangle texel, primitive), barycentrics; query 1: direction. Answer 0: position, whether
// the ray that leaves it meets its own triangle; 1: error bound, whether it does so when told to skip it; 2:
// the origin.
PROBE_CONSTANT PROBE_SPAWNED_RAYS = 2;
// Films of passes over samples [i · n, (i + 1) · n) that are 0.1, and SPIKE at the multiples of query.x.
// Answer 0: mean.
PROBE_CONSTANT PROBE_PASS_FILMS = 3;
// environmentSample for sample i: direction, pdf; radiance, pdf that environmentAlong has for the direction.
PROBE_CONSTANT PROBE_ENVIRONMENT = 4;
// query 0: direction of travel, g; query 1: direction after it. Answer: phasePdf of it.
PROBE_CONSTANT PROBE_PHASE = 5;
// query 0 of all: direction of travel, g. Answer: phaseSample for sample i and its pdf; phasePdf of that direction.
PROBE_CONSTANT PROBE_PHASE_SAMPLES = 6;
// Answer: exponential() (shaders/path/medium.glsl) of the bits of query.xy.
PROBE_CONSTANT PROBE_EXPONENTIAL = 7;
// query: direction in the shading frame, alpha. Answer 0: Smith's masking G1 of GGX, Beckmann, Phong; 1: their D at that
// direction; 2: Phong's exponent as the integrators without paths have it.
PROBE_CONSTANT PROBE_MASKING = 8;

#define PROBE_SPIKE 1e4
#define PROBE_PASS_SAMPLES 256

#undef PROBE_CONSTANT
#endif
