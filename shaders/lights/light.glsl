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

struct LightSample {
    vec3 target;     // end of the shadow ray from `origin`; infinitely far lights: a direction
    vec3 origin;
    bool infinite;
    vec3 wi;         // unit, from the surface
    vec3 radiance;   // over the selection probability where `pdf` is 0
    float pdf;       // solid angle times selection, 1/sr; 0 for lights that no ray can meet
};

// Surfaces that emit and are lights of their own.
#define emitterBits() \
    (featureBit(FEATURE_EMISSIVE_TRIANGLES) | featureBit(FEATURE_QUAD_LIGHTS) | featureBit(FEATURE_SPHERE_LIGHTS))
#define hasEmitters() (emitterBits() != 0u)
#define hasLights() \
    ((emitterBits() | featureBit(FEATURE_PUNCTUAL_LIGHTS) | featureBit(FEATURE_SUN_LIGHTS) | featureBit(FEATURE_ENVIRONMENT)) != 0u)

bool lightsFollow(uint rule) { return (parameters.lights.x & rule) != 0u; }
#define lightsByTree() (has(FEATURE_LIGHT_TREE) && lightsFollow(LIGHTS_BY_TREE))
#define lightsAll() (has(FEATURE_ALL_LIGHTS) && lightsFollow(LIGHTS_ALL))
#define lightsAlone() (has(FEATURE_SINGLE_SAMPLING) && lightsFollow(LIGHTS_ALONE))
#define lightsByBsdf() (has(FEATURE_SINGLE_SAMPLING) && lightsFollow(LIGHTS_BY_BSDF))

vec4 lightTexel(uint light, uint texel) { return uintBitsToFloat(LOAD(lightTexels, light * LIGHT_TEXELS + texel)); }

// Of `count` lights from `first` on, which have a table of their own.
uint chooseLight(uvec4 bits, uint first, uint count) {
    uint light = first + scaledIndex(bits.x, count);
    uvec4 entry = LOAD(lightAliasTexels, light);
    return bits.y < entry.x ? light : entry.y;
}

// Probability of choosing a light at a point p whose surface sees lights on the side of n (zero: on both).
float lightPmf(uint light, float pmf, vec3 p, vec3 n) { return lightsByTree() ? lightTreePmf(light, p, n) : pmf; }

// What leaves the point u of a triangle at an angle to its normal, of what its material emits.
vec3 emissionOfTriangle(vec3 emission, VertexIndices v, uint flags, vec2 u, float cosine) {
    uint emissionTexture = LOAD(materialTexels, v.material * MATERIAL_TEXELS + 5u).w;
    bool textured = has(FEATURE_TEXTURES) && emissionTexture != NO_INDEX, cutOut = has(FEATURE_CUTOUT) && isCutOut(flags);
    if (!textured && !cutOut && !has(FEATURE_CLEARCOAT)) return emission;
    vec3 barycentrics = vec3(1.0 - u.x - u.y, u);
    vec2 uv0, uv1;
    loadTexCoords(v, barycentrics, interpolateTexel(v, barycentrics, 0u).w, uv0, uv1);
    if (textured) emission *= sampleTexture(emissionTexture, uv0, uv1).rgb;
    if (has(FEATURE_CLEARCOAT)) emission *= emissionThroughCoat(v.material, uv0, uv1, cosine);
    if (cutOut) emission *= coverageAt(v.material, flags, uv0, uv1, loadColor(v, barycentrics));
    return emission;
}

bool sampleTriangleLight(uint light, uvec4 head, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    vec2 u = uniformTriangle(unitFloat(bits.zw));
    vec3 position = p.xyz + u.x * a.xyz + u.y * b.xyz;
    vec3 error = gammaBound(7.0) * (abs(p.xyz) + abs(u.x * a.xyz) + abs(u.y * b.xyz));
    vec3 toLight = position - s.position;
    float distanceSquared = dot(toLight, toLight);
    if (!(distanceSquared > 0.0)) return false;
    l.wi = toLight * inversesqrt(distanceSquared);
    vec3 normal = normalize(cross(a.xyz, b.xyz));
    float cosine = dot(normal, -l.wi);

    VertexIndices v = loadPrimitive(head.y);
    uint flags = LOAD(materialTexels, v.material * MATERIAL_TEXELS + 3u).y;
    if (!emitsTowards(flags, cosine >= 0.0)) return false;
    l.radiance = emissionOfTriangle(vec3(p.w, a.w, b.w), v, flags, u, abs(cosine));
    l.pdf = pmf * areaToSolidAngle(uintBitsToFloat(head.w), distanceSquared, abs(cosine));
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(position, error, normal, -l.wi);
    l.infinite = false;
    return l.pdf > 0.0;
}

bool sampleQuadLight(uint light, uvec4 head, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    SphericalRectangle r = sphericalRectangle(p.xyz, a.xyz, b.xyz, s.position);
    if (!(r.solidAngle > 0.0) || !(r.front || head.y != 0u)) return false;
    vec2 at = quadSample(r, unitFloat(bits.zw));
    vec3 inPlane = vec3(at, r.h);
    float distance = length(inPlane);
    inPlane /= distance;
    // Edges of a sliver far from the origin are at right angles only within the rounding of its corners.
    l.wi = normalize(inPlane.x * r.x + inPlane.y * r.y + inPlane.z * r.z);
    vec2 u = (at - vec2(r.x0, r.y0)) / vec2(r.x1 - r.x0, r.y1 - r.y0);
    vec3 position = p.xyz + u.x * a.xyz + u.y * b.xyz;
    vec3 error = gammaBound(7.0) * (abs(p.xyz) + abs(u.x * a.xyz) + abs(u.y * b.xyz));
    l.radiance = vec3(p.w, a.w, b.w);
    l.pdf = pmf * quadPdf(r, distance);
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(position, error, r.z, -l.wi);
    l.infinite = false;
    return l.pdf > 0.0;
}

bool sampleSphereLight(uint light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    SphereCone c = sphereCone(p.xyz, a.x, s.position);
    if (!(c.h > 0.0)) return false;
    float reach;
    l.wi = sphereSample(c, a.x, unitFloat(bits.zw), reach);
    l.radiance = vec3(p.w, a.w, b.w);
    l.pdf = pmf * spherePdf(c);
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = s.position + max(reach, 0.0) * l.wi;
    l.infinite = false;
    return l.pdf > 0.0;
}

bool sampleSunLight(uint light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    l.wi = sunSample(-a.xyz, b.x, unitFloat(bits.zw));
    l.radiance = vec3(p.w, a.w, b.w);
    l.pdf = pmf * sunPdf(b.x);
    l.infinite = true;
    l.target = l.wi;
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    return true;
}

bool samplePunctualLight(uint light, uvec4 head, float pmf, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    l.radiance = vec3(p.w, a.w, b.w) / pmf;
    l.pdf = 0.0;
    l.infinite = head.x == LIGHT_DIRECTIONAL;
    if (l.infinite) {
        l.wi = -a.xyz;
        l.target = l.wi;
    } else {
        vec3 toLight = p.xyz - s.position;
        float distanceSquared = dot(toLight, toLight);
        if (!(distanceSquared > 0.0)) return false;
        l.wi = toLight * inversesqrt(distanceSquared);
        l.target = p.xyz;
        l.radiance *= rangeWindow(distanceSquared, b.z) / distanceSquared;
        if (head.x == LIGHT_SPOT) l.radiance *= spotFalloff(dot(-l.wi, a.xyz), b.x, b.y);
    }
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    return maxComponent(l.radiance) > 0.0;
}

bool sampleEnvironmentLight(SampleKey key, uint bounce, float pmf, Surface s, inout LightSample l) {
    uvec4 more = randomBits(key, bounceDimension(bounce, DIMENSION_ENVIRONMENT));
    l.wi = environmentSample(more, l.radiance, l.pdf);
    l.pdf *= pmf;
    l.infinite = true;
    l.target = l.wi;
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    return l.pdf > 0.0;
}

// A point on one light. False where nothing can arrive. `radiance` is to be divided by `pdf` where that is not 0.
bool sampleOnLight(uint light, uvec4 head, float pmf, uvec4 bits, SampleKey key, uint bounce, Surface s,
                   out LightSample l) {
    if (has(FEATURE_ENVIRONMENT) && head.x == LIGHT_ENVIRONMENT) return sampleEnvironmentLight(key, bounce, pmf, s, l);
    if (has(FEATURE_EMISSIVE_TRIANGLES) && head.x == LIGHT_TRIANGLE)
        return sampleTriangleLight(light, head, pmf, bits, s, l);
    if (has(FEATURE_QUAD_LIGHTS) && head.x == LIGHT_QUAD) return sampleQuadLight(light, head, pmf, bits, s, l);
    if (has(FEATURE_SPHERE_LIGHTS) && head.x == LIGHT_SPHERE) return sampleSphereLight(light, pmf, bits, s, l);
    if (has(FEATURE_SUN_LIGHTS) && head.x == LIGHT_SUN) return sampleSunLight(light, pmf, bits, s, l);
    if (has(FEATURE_PUNCTUAL_LIGHTS)) return samplePunctualLight(light, head, pmf, s, l);
    return false;
}

// One light, chosen. `n`: the side that the surface sees lights on, see lightPmf.
bool sampleLight(SampleKey key, uint bounce, Surface s, vec3 n, out LightSample l) {
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_LIGHT));
    uint light;
    float pmf;
    if (parameters.path.z == 0u) return false;
    if (lightsByTree()) {
        if (!lightTreeSample(bits.xy, s.position, n, light, pmf)) return false;
    } else {
        light = chooseLight(bits, 0u, parameters.path.z);
    }
    uvec4 head = LOAD(lightTexels, light * LIGHT_TEXELS);
    if (!lightsByTree()) pmf = uintBitsToFloat(head.z);
    return sampleOnLight(light, head, pmf, bits, key, bounce, s, l);
}

uint firstOfGroup(uint group) { return LOAD(lightAliasTexels, group).w; }

// One light of a given group, with random numbers of its own.
bool sampleGroup(uint group, SampleKey key, uint bounce, Surface s, out LightSample l) {
    key.stream = pcg4d(uvec4(key.stream, group, 0x6561u, 0x6368u)).x;
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_LIGHT));
    uint first = firstOfGroup(group);
    uint end = group + 1u < parameters.lights.y ? firstOfGroup(group + 1u) : parameters.path.z;
    uint light = chooseLight(bits, first, end - first);
    uvec4 head = LOAD(lightTexels, light * LIGHT_TEXELS);
    return sampleOnLight(light, head, uintBitsToFloat(head.z), bits, key, bounce, s, l);
}

// Pdf with which light sampling at `from` (see lightPmf for n) would have found the point of an emissive surface that
// a ray met at the distance t. `throughVeil`: after it came through the near side of the same thing, which is cut out;
// on spheres light sampling finds only the near side.
float emitterPdf(uint primitive, vec3 from, vec3 n, float t, float cosine, bool throughVeil) {
    uint light = LOAD(primitiveLightTexels, primitive >> 2u)[primitive & 3u];
    if (light == NO_INDEX) return 0.0;
    uvec4 head = LOAD(lightTexels, light * LIGHT_TEXELS);
    float pmf = lightPmf(light, uintBitsToFloat(head.z), from, n);
    if (has(FEATURE_QUAD_LIGHTS) && head.x == LIGHT_QUAD) {
        vec3 p = lightTexel(light, 1u).xyz, a = lightTexel(light, 2u).xyz, b = lightTexel(light, 3u).xyz;
        return pmf * quadPdf(sphericalRectangle(p, a, b, from), t);
    }
    if (has(FEATURE_SPHERE_LIGHTS) && head.x == LIGHT_SPHERE)
        return throughVeil ? 0.0 : pmf * spherePdf(sphereCone(lightTexel(light, 1u).xyz, lightTexel(light, 2u).x, from));
    return pmf * areaToSolidAngle(uintBitsToFloat(head.w), t * t, cosine);
}

float environmentPmf(vec3 from, vec3 n) {
    uint light = parameters.path.w;
    return lightPmf(light, uintBitsToFloat(LOAD(lightTexels, light * LIGHT_TEXELS).z), from, n);
}

#endif
