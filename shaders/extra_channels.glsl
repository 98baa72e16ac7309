// Channels beyond the picture that a job may ask for (shared/film/layout.h): what a sample has of them, and its part
// in the film, texels behind those of PassPixel.
#ifndef EXTRA_CHANNELS_GLSL
#define EXTRA_CHANNELS_GLSL

struct ExtraSample {
    vec3 light[LIGHT_PATH_COUNT];  // radiance by LIGHT_PATH_*
    vec2 uv;                       // of the first surface
    uvec2 matte;                   // ids of its object and material, 0 where there is none
};
ExtraSample extra;  // of the sample under way

layout(binding = BINDING_MATTES) uniform usamplerBuffer matteTexels;

void beginExtra() {
    if (has(FEATURE_LIGHT_PATHS))
        for (uint i = 0u; i < LIGHT_PATH_COUNT; i++) extra.light[i] = vec3(0);
    extra.uv = vec2(0);
    extra.matte = uvec2(0);
}

// To be told of the surface that the camera sees.
void noteFirstSurface(Surface s) {
    if (has(FEATURE_UV_CHANNEL)) extra.uv = s.uv0;
    if (has(FEATURE_CRYPTOMATTE)) {
        uvec4 two = LOAD(matteTexels, s.primitive >> 1u);
        extra.matte = (s.primitive & 1u) == 0u ? two.xy : two.zw;
    }
}

void clearExtra(uint texel) {
    for (uint end = texel + FILM_STRIDE - FILM_TEXELS; texel < end; texel++) film[texel] = vec4(0);
}

// Counts a sample for its id, where the id is known or there is room. A pair is an id and a number of samples; two
// stand in a texel.
void countMatte(uint texel, uint id) {
    for (uint pair = 0u; pair < MATTE_RANKS; pair++) {
        uint at = texel + (pair >> 1u);
        vec2 kept = (pair & 1u) == 0u ? film[at].xy : film[at].zw;
        if (kept.y != 0.0 && floatBitsToUint(kept.x) != id) continue;
        kept = vec2(uintBitsToFloat(id), kept.y + 1.0);
        film[at] = (pair & 1u) == 0u ? vec4(kept, film[at].zw) : vec4(film[at].xy, kept);
        return;
    }
}

// `n`: samples of the pixel, this one with them.
void addExtra(uint texel, float n) {
    if (has(FEATURE_LIGHT_PATHS)) {
        for (uint i = 0u; i < LIGHT_PATH_COUNT; i++) film[texel + i].rgb += (extra.light[i] - film[texel + i].rgb) / n;
        texel += LIGHT_PATH_COUNT;
    }
    if (has(FEATURE_UV_CHANNEL)) {
        film[texel].xy += (extra.uv - film[texel].xy) / n;
        texel++;
    }
    if (has(FEATURE_CRYPTOMATTE)) {
        if (extra.matte.x != 0u) countMatte(texel, extra.matte.x);
        if (extra.matte.y != 0u) countMatte(texel + MATTE_TEXELS, extra.matte.y);
    }
}

#endif
