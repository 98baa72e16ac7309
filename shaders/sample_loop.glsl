// The body of every integrator's kernel: one invocation per pixel, several samples each, summed up in the film. The
// including file defines `PathSample traceSample(SampleKey key, vec3 origin, vec3 direction)`; or SHADES_A_DRAW with a
// `renderSample` of its own for the pixels of the block that was drawn.
#ifndef SAMPLE_LOOP_GLSL
#define SAMPLE_LOOP_GLSL

#ifndef SHADES_A_DRAW
PathSample renderSample(uvec2 pixel, SampleKey key) {
    vec2 u = unitFloat(randomBits(key, DIMENSION_PIXEL).xy);
    vec3 origin, direction;
    cameraRay(key, vec2(pixel) + filterSample(u), origin, direction);
    return traceSample(key, origin, direction);
}
#endif

void main() {
    uvec2 inTile = gl_GlobalInvocationID.xy + uvec2(0, pass.firstRow);
    uvec4 tile = tiles[gl_WorkGroupID.z];
    if (any(greaterThanEqual(inTile, tile.zw))) return;
    uvec2 pixel = tile.xy + inTile;
#ifdef SHADES_A_DRAW
    if (!inDrawnBlock(pixel)) return;
#endif
    uint at = gl_WorkGroupID.z * pass.tileSize * pass.tileSize + inTile.y * pass.tileSize + inTile.x;

    FilmPixel result = emptyPixel();
    if (pass.continued != 0u) result = loadPixel(at);
    else if (FILM_STRIDE > FILM_TEXELS) clearExtra(FILM_STRIDE * at + FILM_TEXELS);
    SampleKey key;
    key.pixel = pixel.x | pixel.y << 16u;
    key.stream = streamKey(parameters.seed, parameters.frame);
    uint dropped = 0u;
    for (uint i = 0u; i < pass.sampleCount; i++) {
        key.index = pass.firstSample + i * pass.sampleStride;
        beginExtra();
        PathSample s = renderSample(pixel, key);
        // A sample that is not finite leaves with its weight and is counted, never hidden.
        if (isFinite(s.radiance)) {
            addSample(result, s);
            if (FILM_STRIDE > FILM_TEXELS) addExtra(FILM_STRIDE * at + FILM_TEXELS, result.mean.w);
        } else {
            dropped++;
            uint record = atomicAdd(counters[COUNTER_RECORDED], 1u);
            if (record < RECORDED_SAMPLES) {
                counters[COUNTER_FIRST_DROPPED + 2u * record] = key.pixel;
                counters[COUNTER_FIRST_DROPPED + 2u * record + 1u] = key.index;
            }
        }
    }
    storePixel(at, result);
    if (dropped != 0u) addToCounter(COUNTER_DROPPED_SAMPLES, dropped);
    uint ofTile = COUNTER_COUNT + gl_WorkGroupID.z * TILE_COUNTERS;
    addToCounter(ofTile + TILE_RAYS, ExactSum(rayCount, 0u));
    if (rejectedCount != 0u) addToCounter(ofTile + TILE_REJECTED, rejectedCount);
    if (truncatedCount != 0u) {
        addToCounter(ofTile + TILE_TRUNCATED, truncatedCount);
        addToCounter(ofTile + TILE_TRUNCATED_THROUGHPUT, truncatedThroughput);
    }
    if (behindGlassCount != 0u) addToCounter(ofTile + TILE_BEHIND_GLASS, behindGlassCount);
    if (has(FEATURE_CLAMP) && clampedCount != 0u) {
        addToCounter(ofTile + TILE_CLAMPED, clampedCount);
        addToCounter(ofTile + TILE_CLAMPED_RADIANCE, clampedRadiance);
    }
}

#endif
