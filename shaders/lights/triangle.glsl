// Emissive triangles, sampled uniformly by area.
// LightRecord: corner p, edges a and b, `area`, `primitive`; the value is the material's emission.
#ifndef TRIANGLE_LIGHT_GLSL
#define TRIANGLE_LIGHT_GLSL

#include "light_sample.glsl"

// Solid-angle pdf, 1/sr, of a point chosen uniformly on `area` at squared distance and cosine.
float areaToSolidAngle(float area, float distanceSquared, float cosine) {
    return cosine > 0.0 ? distanceSquared / (cosine * area) : 0.0;
}

// Radiance that a primitive's material sends towards wo, given which side wo sees.
bool emitsTowards(uint flags, bool frontFace) { return frontFace || (flags & MATERIAL_DOUBLE_SIDED) != 0u; }

// What leaves the point u of a triangle at an angle to its normal, of what its material emits.
vec3 emissionOfTriangle(vec3 emission, VertexIndices v, uint flags, vec2 u, float cosine) {
    uint emissionTexture = materialEmissionTexture(v.material);
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

bool sampleTriangleLight(LightRecord light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    vec2 u = uniformTriangle(unitFloat(bits.zw));
    vec3 position = light.p + u.x * light.a + u.y * light.b;
    vec3 error = gammaBound(7.0) * (abs(light.p) + abs(u.x * light.a) + abs(u.y * light.b));
    vec3 toLight = position - s.position;
    float distanceSquared = dot(toLight, toLight);
    if (!(distanceSquared > 0.0)) return false;
    l.wi = toLight * inversesqrt(distanceSquared);
    vec3 normal = normalize(cross(light.a, light.b));
    float cosine = dot(normal, -l.wi);

    VertexIndices v = loadPrimitive(light.primitive);
    uint flags = materialFlags(v.material);
    if (!emitsTowards(flags, cosine >= 0.0)) return false;
    l.radiance = emissionOfTriangle(lightValue(light), v, flags, u, abs(cosine));
    l.pdf = pmf * areaToSolidAngle(light.area, distanceSquared, abs(cosine));
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(position, error, normal, -l.wi);
    l.infinite = false;
    return l.pdf > 0.0;
}

// Solid-angle pdf, 1/sr, with which a point of it at distance t is sampled.
float triangleLightPdf(LightRecord light, float t, float cosine) { return areaToSolidAngle(light.area, t * t, cosine); }

// 1 / sr, of the whole triangle: unlike area over squared distance it stays finite where the light is near.
float wholeTrianglePdf(LightRecord light, vec3 from) {
    vec3 p = light.p - from;
    return 1.0 / max(triangleSolidAngle(abs(dot(p, cross(light.a, light.b))), p, p + light.a, p + light.b), 1e-30);
}

#endif
