// One light per surface point, chosen by power through an alias table, and the pdfs that multiple
// importance sampling needs when a path meets a light by itself.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "environment.glsl"
#include "triangle.glsl"
#include "punctual.glsl"

struct LightSample {
    vec3 target;     // end of the shadow ray from `origin`; infinitely far lights: a direction
    vec3 origin;
    bool infinite;
    vec3 wi;         // unit, from the surface
    vec3 radiance;   // over the selection probability
    float pdf;       // solid angle times selection, 1/sr; 0 for lights that no ray can meet
};

bool hasLights() { return has(FEATURE_EMISSIVE_TRIANGLES) || has(FEATURE_PUNCTUAL_LIGHTS) || has(FEATURE_ENVIRONMENT); }

vec4 lightTexel(uint light, uint texel) { return uintBitsToFloat(LOAD(lightTexels, light * LIGHT_TEXELS + texel)); }

uint chooseLight(uvec4 bits) {
    uint light = scaledIndex(bits.x, parameters.path.z);
    uvec4 entry = LOAD(lightAliasTexels, light);
    return bits.y < entry.x ? light : entry.y;
}

bool sampleTriangleLight(uint light, uvec4 head, uvec4 bits, Surface s, inout LightSample l) {
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
    l.radiance = vec3(p.w, a.w, b.w);
    uint emissionTexture = LOAD(materialTexels, v.material * MATERIAL_TEXELS + 5u).w;
    if (has(FEATURE_TEXTURES) && emissionTexture != NO_INDEX) {
        vec3 barycentrics = vec3(1.0 - u.x - u.y, u);
        vec2 uv0, uv1;
        loadTexCoords(v, barycentrics, interpolateTexel(v, barycentrics, 0u).w, uv0, uv1);
        l.radiance *= sampleTexture(emissionTexture, uv0, uv1).rgb;
    }
    if (has(FEATURE_CLEARCOAT)) {
        vec3 barycentrics = vec3(1.0 - u.x - u.y, u);
        vec2 uv0, uv1;
        loadTexCoords(v, barycentrics, interpolateTexel(v, barycentrics, 0u).w, uv0, uv1);
        l.radiance *= emissionThroughCoat(v.material, uv0, uv1, abs(cosine));
    }
    l.pdf = uintBitsToFloat(head.z) * areaToSolidAngle(uintBitsToFloat(head.w), distanceSquared, abs(cosine));
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(position, error, normal, -l.wi);
    l.infinite = false;
    return l.pdf > 0.0;
}

bool samplePunctualLight(uint light, uvec4 head, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    l.radiance = vec3(p.w, a.w, b.w) / uintBitsToFloat(head.z);
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

// False where nothing can arrive. `radiance` is to be divided by `pdf` where that is not 0.
bool sampleLight(SampleKey key, uint bounce, Surface s, out LightSample l) {
    uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_LIGHT));
    uint light = chooseLight(bits);
    uvec4 head = LOAD(lightTexels, light * LIGHT_TEXELS);
    if (has(FEATURE_ENVIRONMENT) && head.x == LIGHT_ENVIRONMENT) {
        uvec4 more = randomBits(key, bounceDimension(bounce, DIMENSION_ENVIRONMENT));
        l.wi = environmentSample(more, l.radiance, l.pdf);
        l.pdf *= uintBitsToFloat(head.z);
        l.infinite = true;
        l.target = l.wi;
        l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
        return l.pdf > 0.0;
    }
    if (has(FEATURE_EMISSIVE_TRIANGLES) && head.x == LIGHT_TRIANGLE) return sampleTriangleLight(light, head, bits, s, l);
    if (has(FEATURE_PUNCTUAL_LIGHTS)) return samplePunctualLight(light, head, s, l);
    return false;
}

// Pdf with which sampleLight would have found the point of an emissive triangle that a ray met.
float trianglePdf(uint primitive, float distanceSquared, float cosine) {
    uint light = LOAD(primitiveLightTexels, primitive >> 2u)[primitive & 3u];
    if (light == NO_INDEX) return 0.0;
    vec2 pmfArea = uintBitsToFloat(LOAD(lightTexels, light * LIGHT_TEXELS).zw);
    return pmfArea.x * areaToSolidAngle(pmfArea.y, distanceSquared, cosine);
}

float environmentPmf() {
    return uintBitsToFloat(LOAD(lightTexels, parameters.path.w * LIGHT_TEXELS).z);
}

#endif
