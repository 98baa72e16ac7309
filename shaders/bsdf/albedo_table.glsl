// Directional albedos E(cosθ, roughness) tabulated on the host (worker/render/albedo_table.cpp). A texel
// holds the four values that bilinear interpolation needs. Columns: sqrt(cosθ), which resolves grazing
// angles; rows: perceptual roughness; after the last row one of averages 2 ∫ E cosθ dcosθ. A plain table
// holds numbers; one of pairs holds two in the bits of each.
#ifndef ALBEDO_TABLE_GLSL
#define ALBEDO_TABLE_GLSL

// Where a lookup falls: `cell` in the table, fraction `f` within.
void albedoCell(float cosTheta, float alpha, out uint cell, out vec2 f) {
    const float last = float(ALBEDO_TABLE_SIZE - 1u);
    vec2 at = clamp(vec2(sqrt(abs(cosTheta)), sqrt(alpha)), 0.0, 1.0) * last;
    vec2 corner = min(floor(at), last - 1.0);
    f = at - corner;
    cell = uint(corner.y) * ALBEDO_TABLE_SIZE + uint(corner.x);
}

float bilinear(vec4 e, vec2 f) {
    vec2 row = mix(e.xz, e.yw, f.x);
    return mix(row.x, row.y, f.y);
}

vec4 albedoTexel(uint table, uint cell) {
    return texelFetch(albedoTexels, int(table * (ALBEDO_TABLE_SIZE + 1u) * ALBEDO_TABLE_SIZE + cell));
}

vec4 averageTexel(uint table, float alpha, out float f) {
    const float last = float(ALBEDO_TABLE_SIZE - 1u);
    float at = clamp(sqrt(alpha), 0.0, 1.0) * last;
    float cell = min(floor(at), last - 1.0);
    f = at - cell;
    return albedoTexel(table, ALBEDO_TABLE_SIZE * ALBEDO_TABLE_SIZE + uint(cell));
}

// The two numbers of a pair, the same as packPair in albedo_table.cpp: 16 bits, and above them 15 whose
// offset keeps the float from being NaN, infinite or denormal.
vec4 firstOfPairs(vec4 e) { return vec4(floatBitsToUint(e) & 0xffffu) * (1.0 / 65535.0); }
vec4 secondOfPairs(vec4 e) { return vec4((floatBitsToUint(e) >> 16u) - 128u) * (1.0 / 32256.0); }

// Plain tables.
float reflectionAlbedo(uint table, float cosTheta, float alpha) {
    uint cell;
    vec2 f;
    albedoCell(cosTheta, alpha, cell, f);
    return bilinear(albedoTexel(table, cell), f);
}

float averageReflectionAlbedo(uint table, float alpha) {
    float f;
    vec4 e = averageTexel(table, alpha, f);
    return mix(e.x, e.y, f);
}

// Tables of pairs. `both`: else the second is not wanted and 0.
vec2 albedoPair(uint table, float cosTheta, float alpha, bool both) {
    uint cell;
    vec2 f;
    albedoCell(cosTheta, alpha, cell, f);
    vec4 e = albedoTexel(table, cell);
    return vec2(bilinear(firstOfPairs(e), f), both ? bilinear(secondOfPairs(e), f) : 0.0);
}

vec2 averageAlbedoPair(uint table, float alpha) {
    float f;
    vec4 e = averageTexel(table, alpha, f);
    vec4 first = firstOfPairs(e), second = secondOfPairs(e);
    return vec2(mix(first.x, first.y, f), mix(second.x, second.y, f));
}

#endif
