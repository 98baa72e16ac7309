// Sampling a light at a surface point: which one (by power, all alike, one of each group, or by the light tree) and where on it;
// and the pdfs that multiple importance sampling needs when a path meets a light by itself.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "gpu_lights.glsl"
#include "light_tree.glsl"

// Surfaces that emit and are lights of their own.
#define hasEmitters() (EMITTER_FEATURES != 0u)
#define hasLights() (LIGHT_FEATURES != 0u)

bool lightsFollow(uint rule) { return (parameters.lightSelection & rule) != 0u; }
#define lightsByTree() (has(FEATURE_LIGHT_TREE) && lightsFollow(LIGHTS_BY_TREE))
#define lightsAll() (has(FEATURE_ALL_LIGHTS) && lightsFollow(LIGHTS_ALL))
#define lightsAlone() (has(FEATURE_SINGLE_SAMPLING) && lightsFollow(LIGHTS_ALONE))
#define lightsByBsdf() (has(FEATURE_SINGLE_SAMPLING) && lightsFollow(LIGHTS_BY_BSDF))

// Of `count` lights from `first` on, which have a table of their own.
uint chooseLight(uvec4 bits, uint first, uint count) {
    uint light = first + scaledIndex(bits.x, count);
    AliasRecord entry = lightAlias(light);
    return bits.y < entry.threshold ? light : entry.alias;
}

// Probability of choosing a light at a point p whose surface sees lights on the side of n (zero: on both).
float lightPmf(uint light, float pmf, vec3 p, vec3 n) { return lightsByTree() ? lightTreePmf(light, p, n) : pmf; }

// A point on one light. False where nothing can arrive. `radiance` is to be divided by `pdf` where that is not 0.
bool sampleOnLight(LightRecord light, float pmf, uvec4 bits, SampleKey key, uint bounce, Surface s, out LightSample l) {
    SAMPLE_LIGHT
    return false;
}

// One light, chosen. `n`: the side that the surface sees lights on, see lightPmf.
bool sampleLight(SampleKey key, uint bounce, Surface s, vec3 n, out LightSample l) {
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_LIGHT));
    uint light;
    float pmf;
    if (parameters.lightCount == 0u) return false;
    if (lightsByTree()) {
        if (!lightTreeSample(bits.xy, s.position, n, light, pmf)) return false;
    } else {
        light = chooseLight(bits, 0u, parameters.lightCount);
    }
    LightRecord record = loadLightRecord(light);
    return sampleOnLight(record, lightsByTree() ? pmf : record.pmf, bits, key, bounce, s, l);
}

uint firstOfGroup(uint group) { return lightAlias(group).trail; }

// One light of a given group, with random numbers of its own.
bool sampleGroup(uint group, SampleKey key, uint bounce, Surface s, out LightSample l) {
    key.stream = pcg4d(uvec4(key.stream, group, 0x6561u, 0x6368u)).x;
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_LIGHT));
    uint first = firstOfGroup(group);
    uint end = group + 1u < parameters.lightGroups ? firstOfGroup(group + 1u) : parameters.lightCount;
    LightRecord light = loadLightRecord(chooseLight(bits, first, end - first));
    return sampleOnLight(light, light.pmf, bits, key, bounce, s, l);
}

// Pdf with which light sampling at `from` (see lightPmf for n) would have found the point of an emissive surface that
// a ray met at the distance t. `throughVeil`: after it came through the near side of the same thing, which is cut out;
// on spheres light sampling finds only the near side.
float emitterPdf(uint primitive, vec3 from, vec3 n, float t, float cosine, bool throughVeil) {
    uint index = LOAD(primitiveLightTexels, primitive >> 2u)[primitive & 3u];
    if (index == NO_INDEX) return 0.0;
    LightRecord light = loadLightRecord(index);
    float pmf = lightPmf(index, light.pmf, from, n);
    LIGHT_PDF
}

float environmentPmf(vec3 from, vec3 n) {
    uint light = parameters.environmentLight;
    return lightPmf(light, loadLightRecord(light).pmf, from, n);
}

#endif
