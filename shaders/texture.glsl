// Texture lookups in fp32, in software, so that every device filters alike.
#ifndef TEXTURE_GLSL
#define TEXTURE_GLSL

// IEC 61966-2-1.
vec3 srgbToLinear(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

int wrapCoordinate(int i, int n, uint mode) {
    if (mode == 2u) return clamp(i, 0, n - 1);
    int period = mode == 1u ? 2 * n : n;
    i %= period;
    if (i < 0) i += period;
    return i < n ? i : period - 1 - i;
}

// Of a column and a row of the image.
vec4 texelOf(TextureRecord t, int x, int y) {
    int index = int(t.firstTexel) + y * int(t.width) + x;
    if (has(FEATURE_FLOAT_TEXTURES) && (t.flags & TEXTURE_FLOAT) != 0u) return texelFetch(texels32, index);
    vec4 texel = texelFetch(texels8, index);
    // Decoded before filtering: blending encoded values darkens edges.
    if ((t.flags & TEXTURE_SRGB) != 0u) texel.rgb = srgbToLinear(texel.rgb);
    return texel;
}

// Value of texture `index` at the texture coordinates of a surface point.
vec4 sampleTexture(uint index, vec2 uv0, vec2 uv1) {
    TextureRecord t = loadTextureRecord(index);
    vec2 uv = has(FEATURE_SECOND_UV_SET) && (t.flags & TEXTURE_UV1) != 0u ? uv1 : uv0;
    if (has(FEATURE_TEXTURE_TRANSFORMS) && (t.flags & TEXTURE_TRANSFORM) != 0u) uv = t.du * uv.x + t.dv * uv.y + t.offset;
    // Far outside the unit square the integer texel would overflow; wrapping has the period 2.
    uv -= 2.0 * floor(0.5 * clamp(uv, vec2(-1e9), vec2(1e9))) * vec2(notEqual(uvec2(t.flags >> TEXTURE_WRAP_S_SHIFT, t.flags >> TEXTURE_WRAP_T_SHIFT) & 3u, uvec2(2u)));
    vec2 at = clamp(uv, vec2(-1e4), vec2(1e4)) * vec2(t.width, t.height);
    bool nearest = has(FEATURE_NEAREST_FILTER) && (t.flags & TEXTURE_LINEAR_FILTER) == 0u;
    if (!nearest) at -= 0.5;
    vec2 cell = floor(at);
    vec2 f = at - cell;
    ivec2 c = ivec2(cell);
    uint wrapS = (t.flags >> TEXTURE_WRAP_S_SHIFT) & 3u, wrapT = (t.flags >> TEXTURE_WRAP_T_SHIFT) & 3u;
    int left = wrapCoordinate(c.x, int(t.width), wrapS), top = wrapCoordinate(c.y, int(t.height), wrapT);
    vec4 first = texelOf(t, left, top);
    if (nearest) return first;
    int right = wrapCoordinate(c.x + 1, int(t.width), wrapS), bottom = wrapCoordinate(c.y + 1, int(t.height), wrapT);
    vec4 upper = mix(first, texelOf(t, right, top), f.x);
    vec4 lower = mix(texelOf(t, left, bottom), texelOf(t, right, bottom), f.x);
    return mix(upper, lower, f.y);
}

#endif
