// Lights as the cheap integrators see them: all that a light sends arrives from one point, the middle of it. The
// environment is left to ambient.glsl. No random numbers, so one sample is a whole picture.
#ifndef CENTRE_LIGHT_GLSL
#define CENTRE_LIGHT_GLSL

// Beyond this many lights as many are picked by power, the same ones everywhere.
const uint kMostCentreLights = 64u;

uint centreLightCount() { return min(parameters.lightCount, kMostCentreLights); }

// The i-th light to ask, and how many lights it stands for.
uint pickedLight(uint i, out float times) {
    uint count = parameters.lightCount;
    times = 1.0;
    if (count <= kMostCentreLights) return i;
    // The middle of the i-th of kMostCentreLights strata of the alias table.
    uint light = scaledIndex(i * (0xffffffffu / kMostCentreLights) + 0x80000000u / kMostCentreLights, count);
    AliasRecord entry = lightAlias(light);
    if (pcg4d(uvec4(i, 0x6d69u, 0x6464u, 0x6c65u)).x >= entry.threshold) light = entry.alias;
    times = 1.0 / (float(kMostCentreLights) * max(lightAlias(light).pmf, 1e-30));
    return light;
}

// Random numbers that lead to the middle of a triangle, and of what is sampled around its middle.
const uvec4 kTriangleMiddle = uvec4(0xaaaaaaabu);
const uvec4 kDiskMiddle = uvec4(0u);

// The i-th light's middle as seen from a surface; `radiance` is ready to be multiplied by BRDF times cosine. False
// where nothing arrives. `extended`: a ray can meet the light.
bool centreLight(uint i, SampleKey key, Surface s, out LightSample l, out bool extended) {
    float times;
    LightRecord light = loadLightRecord(pickedLight(i, times));
    extended = false;
    bool found = false;
    if (light.type == LIGHT_ENVIRONMENT) return false;
    CENTRE_OF_LIGHT(found)
        found = sampleOnLight(light, 1.0, light.type == LIGHT_TRIANGLE ? kTriangleMiddle : kDiskMiddle, key, 0u, s, l);
    if (!found) return false;
    extended = l.pdf > 0.0;
    if (extended && has(FEATURE_EMISSIVE_TRIANGLES) && light.type == LIGHT_TRIANGLE) l.pdf = wholeTrianglePdf(light, s.position);
    l.radiance *= extended ? times / l.pdf : times;
    return true;
}

#endif
