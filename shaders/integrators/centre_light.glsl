// Lights as the cheap integrators see them: all that a light sends arrives from one point, the middle of it. The
// environment is left to ambient.glsl. No random numbers, so one sample is a whole picture.
#ifndef CENTRE_LIGHT_GLSL
#define CENTRE_LIGHT_GLSL

// Beyond this many lights as many are picked by power, the same ones everywhere.
const uint kMostCentreLights = 64u;

uint centreLightCount() { return min(parameters.path.z, kMostCentreLights); }

// The i-th light to ask, and how many lights it stands for.
uint pickedLight(uint i, out float times) {
    uint count = parameters.path.z;
    times = 1.0;
    if (count <= kMostCentreLights) return i;
    // The middle of the i-th of kMostCentreLights strata of the alias table.
    uint light = scaledIndex(i * (0xffffffffu / kMostCentreLights) + 0x80000000u / kMostCentreLights, count);
    uvec4 entry = LOAD(lightAliasTexels, light);
    if (pcg4d(uvec4(i, 0x6d69u, 0x6464u, 0x6c65u)).x >= entry.x) light = entry.y;
    times = 1.0 / (float(kMostCentreLights) * max(uintBitsToFloat(LOAD(lightAliasTexels, light).z), 1e-30));
    return light;
}

// Random numbers that lead to the middle of a triangle, and of what is sampled around its middle.
const uvec4 kTriangleMiddle = uvec4(0xaaaaaaabu);
const uvec4 kDiskMiddle = uvec4(0u);

bool centreOfQuad(uint light, uvec4 head, Surface s, inout LightSample l) {
    vec4 p = lightTexel(light, 1u), a = lightTexel(light, 2u), b = lightTexel(light, 3u);
    SphericalRectangle r = sphericalRectangle(p.xyz, a.xyz, b.xyz, s.position);
    if (!(r.solidAngle > 0.0) || !(r.front || head.y != 0u)) return false;
    vec3 middle = p.xyz + 0.5 * a.xyz + 0.5 * b.xyz;
    vec3 error = gammaBound(7.0) * (abs(p.xyz) + abs(0.5 * a.xyz) + abs(0.5 * b.xyz));
    l.wi = normalize(middle - s.position);
    l.radiance = vec3(p.w, a.w, b.w);
    l.pdf = 1.0 / r.solidAngle;
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(middle, error, r.z, -l.wi);
    l.infinite = false;
    return true;
}

// 1 / sr, of the whole triangle: unlike area over squared distance it stays finite where the light is near.
float trianglePdf(uint light, vec3 from) {
    vec3 p = lightTexel(light, 1u).xyz - from, a = lightTexel(light, 2u).xyz, b = lightTexel(light, 3u).xyz;
    return 1.0 / max(triangleSolidAngle(abs(dot(p, cross(a, b))), p, p + a, p + b), 1e-30);
}

// The i-th light's middle as seen from a surface; `radiance` is ready to be multiplied by BRDF times cosine. False
// where nothing arrives. `extended`: a ray can meet the light.
bool centreLight(uint i, SampleKey key, Surface s, out LightSample l, out bool extended) {
    float times;
    uint light = pickedLight(i, times);
    uvec4 head = LOAD(lightTexels, light * LIGHT_TEXELS);
    extended = false;
    bool found = false;
    if (head.x == LIGHT_ENVIRONMENT) return false;
    if (has(FEATURE_QUAD_LIGHTS) && head.x == LIGHT_QUAD)
        found = centreOfQuad(light, head, s, l);
    else
        found = sampleOnLight(light, head, 1.0, head.x == LIGHT_TRIANGLE ? kTriangleMiddle : kDiskMiddle, key, 0u, s, l);
    if (!found) return false;
    extended = l.pdf > 0.0;
    if (extended && has(FEATURE_EMISSIVE_TRIANGLES) && head.x == LIGHT_TRIANGLE) l.pdf = trianglePdf(light, s.position);
    l.radiance *= extended ? times / l.pdf : times;
    return true;
}

#endif
