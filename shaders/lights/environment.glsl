// Equirectangular environment: bilinear radiance, sampled in exact proportion to bilinear
// (luminance · sinθ). A texel is chosen by the alias table and a tent around its centre; the sum of
// those tents is the bilinear interpolant itself, so no direction with light has a zero pdf.
//
// u = 1/2 + atan2(z, x) / 2π, v = acos(y) / π from the top: as Blender and three.js have it.
#ifndef ENVIRONMENT_GLSL
#define ENVIRONMENT_GLSL

#include "light_sample.glsl"

vec4 environmentTexel(int x, int y) {
    ivec2 size = ivec2(parameters.environmentSize);
    x = x < 0 ? x + size.x : x >= size.x ? x - size.x : x;
    y = clamp(y, 0, size.y - 1);
    return texelFetch(environmentTexels, y * size.x + x);  // rgb radiance, a = luminance · sinθ of the row
}

// Radiance at (u, v) in rgb and the solid-angle pdf of environmentSample, 1/sr, in a.
vec4 environmentAt(vec2 uv) {
    vec2 at = uv * vec2(parameters.environmentSize) - 0.5;
    vec2 cell = floor(at);
    vec2 f = at - cell;
    int x = int(cell.x), y = int(cell.y);
    vec4 top = mix(environmentTexel(x, y), environmentTexel(x + 1, y), f.x);
    vec4 bottom = mix(environmentTexel(x, y + 1), environmentTexel(x + 1, y + 1), f.x);
    vec4 value = mix(top, bottom, f.y);
    float sinTheta = max(sin(PI * uv.y), 1e-7);
    value.a *= parameters.environmentInverseWeight * parameters.environmentTexelsPerSteradian / sinTheta;
    return value;
}

// Counter-clockwise seen from above, which is towards smaller u: u of the map for u of the world.
bool environmentTurned() { return has(FEATURE_ENVIRONMENT_ROTATION) && parameters.environmentTurns != 0.0; }
float turned(float u, float turns) {
    u += turns;
    return u - floor(u);
}

vec4 environmentAlong(vec3 direction) {
    float u = 0.5 + atan(direction.z, direction.x) * (0.5 * INV_PI);
    if (environmentTurned()) u = turned(u, parameters.environmentTurns);
    // acos loses half the digits near the poles; atan2 of the two legs does not.
    float v = atan(length(direction.xz), direction.y) * INV_PI;
    return environmentAt(vec2(u, v));
}

// Sum of two uniform numbers less one: a tent on (−1, 1).
float tent(float u) { return u < 0.5 ? sqrt(2.0 * u) - 1.0 : 1.0 - sqrt(2.0 - 2.0 * u); }

vec3 environmentSample(uvec4 bits, out vec3 radiance, out float pdf) {
    uvec2 size = parameters.environmentSize;
    uint texel = scaledIndex(bits.x, size.x * size.y);
    AliasRecord entry = unpackAliasRecord(LOAD(environmentAliasTexels, texel));
    if (bits.y >= entry.threshold) texel = entry.alias;
    vec2 offset = vec2(tent(unitFloat(bits.z)), tent(unitFloat(bits.w)));
    vec2 uv = (vec2(texel % size.x, texel / size.x) + 0.5 + offset) / vec2(size);
    uv.x -= floor(uv.x);
    // Beyond the first and last row the interpolant repeats them: the tent folds back.
    uv.y = uv.y < 0.0 ? -uv.y : uv.y > 1.0 ? 2.0 - uv.y : uv.y;
    vec4 value = environmentAt(uv);
    radiance = value.rgb;
    pdf = value.a;
    if (environmentTurned()) uv.x = turned(uv.x, -parameters.environmentTurns);
    float phi = (uv.x - 0.5) * TWO_PI, theta = uv.y * PI;
    // lint turns: uv is within the map
    return vec3(sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi));
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

#endif
