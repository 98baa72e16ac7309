// Sampling a light at a surface point: which one (by power, all alike, one of each group, or by the light tree) and where on it;
// and the pdfs that multiple importance sampling needs when a path meets a light by itself.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "environment.glsl"
#include "light_tree.glsl"
#include "punctual.glsl"
#include "quad.glsl"
#include "sphere.glsl"
#include "sun.glsl"
#include "triangle.glsl"

// Surfaces that emit and are lights of their own.
#define emitterBits() \
    (featureBit(FEATURE_EMISSIVE_TRIANGLES) | featureBit(FEATURE_QUAD_LIGHTS) | featureBit(FEATURE_SPHERE_LIGHTS))
#define hasEmitters() (emitterBits() != 0u)
#define hasLights() \
    ((emitterBits() | featureBit(FEATURE_PUNCTUAL_LIGHTS) | featureBit(FEATURE_SUN_LIGHTS) | featureBit(FEATURE_ENVIRONMENT)) != 0u)

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
    if (has(FEATURE_ENVIRONMENT) && light.type == LIGHT_ENVIRONMENT) return sampleEnvironmentLight(key, bounce, pmf, s, l);
    if (has(FEATURE_EMISSIVE_TRIANGLES) && light.type == LIGHT_TRIANGLE) return sampleTriangleLight(light, pmf, bits, s, l);
    if (has(FEATURE_QUAD_LIGHTS) && light.type == LIGHT_QUAD) return sampleQuadLight(light, pmf, bits, s, l);
    if (has(FEATURE_SPHERE_LIGHTS) && light.type == LIGHT_SPHERE) return sampleSphereLight(light, pmf, bits, s, l);
    if (has(FEATURE_SUN_LIGHTS) && light.type == LIGHT_SUN) return sampleSunLight(light, pmf, bits, s, l);
    if (has(FEATURE_PUNCTUAL_LIGHTS)) return samplePunctualLight(light, pmf, s, l);
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
    uint light = LOAD(primitiveLightTexels, primitive >> 2u)[primitive & 3u];
    if (light == NO_INDEX) return 0.0;
    LightRecord record = loadLightRecord(light);
    float pmf = lightPmf(light, record.pmf, from, n);
    if (has(FEATURE_QUAD_LIGHTS) && record.type == LIGHT_QUAD) return pmf * quadLightPdf(record, from, t);
    if (has(FEATURE_SPHERE_LIGHTS) && record.type == LIGHT_SPHERE)
        return throughVeil ? 0.0 : pmf * sphereLightPdf(record, from);
    return pmf * triangleLightPdf(record, t, cosine);
}

float environmentPmf(vec3 from, vec3 n) {
    uint light = parameters.environmentLight;
    return lightPmf(light, loadLightRecord(light).pmf, from, n);
}

#endif
