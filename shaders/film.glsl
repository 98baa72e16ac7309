// Running mean and sum of squared deviations of a pixel (Welford 1962), four texels per pixel in the
// layout of PassPixel (shared/film/film.h). Channels that a job asks for beside stand behind (extra_channels.glsl).
#ifndef FILM_GLSL
#define FILM_GLSL

#define FILM_STRIDE                                                                          \
    (FILM_TEXELS + featureBit(FEATURE_LIGHT_PATHS) * LIGHT_PATH_COUNT + featureBit(FEATURE_UV_CHANNEL) + \
     featureBit(FEATURE_CRYPTOMATTE) * 2u * MATTE_TEXELS)

struct PathSample {
    vec3 radiance;
    vec3 albedo;
    vec3 normal;
    float depth;
    float alpha;
};

struct FilmPixel {
    vec4 mean;    // rgb, count of finite samples
    vec4 m2;      // rgb, luminance
    vec4 albedo;  // rgb, depth
    vec4 normal;  // xyz, alpha
};

FilmPixel emptyPixel() { return FilmPixel(vec4(0), vec4(0), vec4(0), vec4(0)); }

FilmPixel loadPixel(uint at) {
    return FilmPixel(film[FILM_STRIDE * at], film[FILM_STRIDE * at + 1u], film[FILM_STRIDE * at + 2u], film[FILM_STRIDE * at + 3u]);
}

void storePixel(uint at, FilmPixel pixel) {
    film[FILM_STRIDE * at] = pixel.mean;
    film[FILM_STRIDE * at + 1u] = pixel.m2;
    film[FILM_STRIDE * at + 2u] = pixel.albedo;
    film[FILM_STRIDE * at + 3u] = pixel.normal;
}

void addSample(inout FilmPixel pixel, PathSample s) {
    float n = pixel.mean.w + 1.0;
    vec3 delta = s.radiance - pixel.mean.rgb;
    pixel.mean = vec4(pixel.mean.rgb + delta / n, n);
    // As δ² (n − 1) / n, which rounding cannot make negative; δ (x − new mean) it can.
    vec4 deviation = vec4(delta, luminance(delta));
    // In this order: the square of a first sample of 1e20 is infinite; times 0 it would be NaN.
    precise vec4 weighted = deviation * ((n - 1.0) / n);
    precise vec4 squares = deviation * weighted;
    pixel.m2 += squares;
    pixel.albedo += (vec4(s.albedo, s.depth) - pixel.albedo) / n;
    pixel.normal += (vec4(s.normal, s.alpha) - pixel.normal) / n;
}

#endif
