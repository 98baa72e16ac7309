// Random numbers as a pure function of (seed, frame, pixel, sample, dimension): a counter hashed, no
// state. A dimension belongs to one use by name, so adding or removing an effect never shifts the
// numbers of another.
#ifndef RNG_GLSL
#define RNG_GLSL

// Blocks of four numbers. Blocks below DIMENSION_BOUNCE belong to the camera ray and the path as a whole.
const uint DIMENSION_PIXEL = 0u;
const uint DIMENSION_LENS = 1u;
const uint DIMENSION_CHANNEL = 2u;  // the colour channel that a dispersed path follows
const uint DIMENSION_TIME = 3u;
const uint DIMENSION_INJECTION = 7u;  // which samples FEATURE_FAULT_INJECTION makes NaN
const uint DIMENSION_BOUNCE = 8u;
// Blocks of one bounce, counted from DIMENSION_BOUNCE + bounce * DIMENSIONS_PER_BOUNCE.
const uint DIMENSION_BSDF = 0u;         // lobe, direction (2), Russian roulette
const uint DIMENSION_LIGHT = 1u;        // alias index, alias threshold, point (2)
const uint DIMENSION_ENVIRONMENT = 2u;  // alias index, alias threshold, offset in the texel (2)
const uint DIMENSION_CUTOUT = 3u;       // the key of cut-outs, hashed with the primitive
const uint DIMENSION_FOG = 4u;          // length of the free flight (2), the channel that draws it
const uint DIMENSION_PHASE = 5u;        // direction (2), -, Russian roulette
const uint DIMENSIONS_PER_BOUNCE = 8u;

struct SampleKey {
    uint pixel;   // x + 65536 y
    uint index;   // sample index
    uint stream;  // hash of seed and frame
};

// Jarzynski, Olano: Hash Functions for GPU Rendering, JCGT 2020 (pcg4d).
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Uniform on the multiples of 2^-24 in [0, 1).
float unitFloat(uint bits) { return float(bits >> 8u) * (1.0 / 16777216.0); }
vec2 unitFloat(uvec2 bits) { return vec2(bits >> 8u) * (1.0 / 16777216.0); }

uint streamKey(uint seed, uint frame) { return pcg4d(uvec4(seed, frame, 0x7469u, 0x6c65u)).x; }

// Bits that have nothing to do with those of any other key.
uvec4 independentBits(SampleKey key, uint dimension) {
    return pcg4d(uvec4(key.pixel, key.index, dimension, key.stream));
}

#include "sampler.glsl"

// The four numbers of a block, from the sampler that the job chose; each is uniform by itself.
uvec4 randomBits(SampleKey key, uint dimension) {
    if (has(FEATURE_SOBOL_SAMPLER) && parameters.samplerKind == SAMPLER_SOBOL) return sobolBits(key, dimension);
    if (has(FEATURE_STRATIFIED_SAMPLER) && parameters.samplerKind == SAMPLER_STRATIFIED)
        return stratifiedBits(key, dimension);
    return independentBits(key, dimension);
}

uint bounceDimension(uint bounce, uint use) {
    return DIMENSION_BOUNCE + bounce * DIMENSIONS_PER_BOUNCE + use;
}

#endif
