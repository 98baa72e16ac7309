// Directional albedo E(cosθ, roughness) of the dielectric reflection lobe, tabulated on the host for
// each index of refraction of the scene (worker/render/albedo_table.cpp). A texel holds the four
// values that bilinear interpolation needs. Columns: sqrt(cosθ), which resolves grazing angles; rows:
// perceptual roughness; after the last row one of averages 2 ∫ E cosθ dcosθ.
#ifndef ALBEDO_TABLE_GLSL
#define ALBEDO_TABLE_GLSL

float reflectionAlbedo(uint table, float cosTheta, float alpha) {
    const float last = float(ALBEDO_TABLE_SIZE - 1u);
    vec2 at = clamp(vec2(sqrt(abs(cosTheta)), sqrt(alpha)), 0.0, 1.0) * last;
    vec2 cell = min(floor(at), last - 1.0);
    vec2 f = at - cell;
    uint first = table * (ALBEDO_TABLE_SIZE + 1u) * ALBEDO_TABLE_SIZE;
    vec4 e = texelFetch(albedoTexels, int(first + uint(cell.y) * ALBEDO_TABLE_SIZE + uint(cell.x)));
    vec2 row = mix(e.xz, e.yw, f.x);
    return mix(row.x, row.y, f.y);
}

float averageReflectionAlbedo(uint table, float alpha) {
    const float last = float(ALBEDO_TABLE_SIZE - 1u);
    float at = clamp(sqrt(alpha), 0.0, 1.0) * last;
    float cell = min(floor(at), last - 1.0);
    uint first = (table * (ALBEDO_TABLE_SIZE + 1u) + ALBEDO_TABLE_SIZE) * ALBEDO_TABLE_SIZE;
    vec4 e = texelFetch(albedoTexels, int(first + uint(cell)));
    return mix(e.x, e.y, at - cell);
}

#endif
