// What one draw shares: a sample of the raster integrator lies at the same place of every pixel, at one moment and at
// one point of the lens. And the block of the image that is drawn.
#ifndef RASTER_SAMPLE_GLSL
#define RASTER_SAMPLE_GLSL

SampleKey frameKey(uint index) { return SampleKey(0u, index, streamKey(parameters.seed, parameters.frame)); }

// Of a pixel, from its corner: the R2 sequence (Roberts 2018) from the middle on, through the pixel filter.
vec2 rasterOffset(uint index) {
    return filterSample(unitFloat(uvec2(0x80000000u) + index * uvec2(3242174889u, 2447445414u)));
}

// x, y, width, height. Blocks are all of one size, so that where a triangle's edge lies does not depend on what else is
// drawn; those at the right and the bottom may reach beyond the image.
uvec4 drawnBlock() {
    uvec2 size = min(parameters.imageSize, uvec2(RASTER_BLOCK));
    uint columns = (parameters.imageSize.x + RASTER_BLOCK - 1u) / RASTER_BLOCK;
    return uvec4(uvec2(pass.block % columns, pass.block / columns) * RASTER_BLOCK, size);
}

bool inDrawnBlock(uvec2 pixel) {
    uvec4 block = drawnBlock();
    return all(greaterThanEqual(pixel, block.xy)) && all(lessThan(pixel, block.xy + block.zw));
}

SampleKey pixelKey(uvec2 pixel, uint index) {
    SampleKey key = frameKey(index);
    key.pixel = pixel.x | pixel.y << 16u;
    return key;
}

// The ray that the draw stands for at a pixel.
Ray rasterRay(uvec2 pixel, uint index) {
    vec3 origin, direction;
    SampleKey key = frameKey(index);
    cameraRay(key, vec2(pixel) + rasterOffset(index), origin, direction);
    uint cutout = has(FEATURE_CUTOUT) ? randomBits(pixelKey(pixel, index), bounceDimension(0u, DIMENSION_CUTOUT)).x : 0u;
    return viewRay(key, origin, direction, cutout);
}

// The first hit of the ray on the shape at a slot.
bool hitShapeAlone(uint slot, Ray ray, out Hit hit) {
    uvec4 head = LOAD(bvhTriangles, slot);
    Candidate best = Candidate(ray.tMax, kNoPrimitive, 0u);
    hitShape(slot, head.x, head.w, ray, ray.tMin, true, best);
    hit = Hit(best.t, best.primitive, vec2(0), slot);
    return best.primitive != kNoPrimitive;
}

#endif
