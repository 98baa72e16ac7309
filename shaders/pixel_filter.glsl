// Filter importance sampling (Ernst, Stamminger, Greiner 2006): samples are spread around the pixel's centre as the
// filter weighs, and count alike. So pixels stay independent of each other, and no weight is ever negative.
#ifndef PIXEL_FILTER_GLSL
#define PIXEL_FILTER_GLSL

// -1 … 1 with density 1 - |x|.
vec2 tentSample(vec2 u) {
    return mix(1.0 - sqrt(max(2.0 - 2.0 * u, vec2(0))), sqrt(2.0 * u) - 1.0, lessThan(u, vec2(0.5)));
}

// Within the unit disk with density exp(-r² / 2σ²), σ = 1/3: a Gaussian cut at 3σ, where it is 1.1 % of its peak.
vec2 gaussianSample(vec2 u) {
    const float inside = 0.98889100346175770;  // 1 - exp(-9/2)
    float r = sqrt(max(-2.0 / 9.0 * log(1.0 - u.x * inside), 0.0));
    float phi = TWO_PI * u.y;
    return vec2(r * cos(phi), r * sin(phi));
}

// The four-term Blackman-Harris window over -1 … 1 (Harris 1978, -92 dB), normalised; and its integral from -1.
float blackmanHarrisPdf(float x) {
    float a = PI * x;
    return 0.5 * (1.0 + (0.48829 * cos(a) + 0.14128 * cos(2.0 * a) + 0.01168 * cos(3.0 * a)) / 0.35875);
}
float blackmanHarrisCdf(float x) {
    float a = PI * x;
    return 0.5 + 0.5 * x + (0.48829 * sin(a) + 0.07064 * sin(2.0 * a) + 0.01168 / 3.0 * sin(3.0 * a)) /
                               (0.35875 * TWO_PI);
}

// Newton's method on the integral within a bracket that halves where a step would leave it.
float blackmanHarrisSample(float u) {
    float low = -1.0, high = 1.0, x = 1.1 * (u - 0.5);
    for (int i = 0; i < 16; i++) {
        float excess = blackmanHarrisCdf(x) - u;
        if (abs(excess) < 1e-7) break;
        if (excess > 0.0) high = x;
        else low = x;
        float next = x - excess / max(blackmanHarrisPdf(x), 1e-3);
        x = next > low && next < high ? next : 0.5 * (low + high);
    }
    return x;
}

// Where in the plane of pixels a sample of the pixel at (0, 0) lies.
vec2 filterSample(vec2 u) {
    if (!has(FEATURE_PIXEL_FILTER)) return u;
    uint kind = uint(parameters.filterKind);
    if (kind == FILTER_PIXEL) return u;
    vec2 offset = vec2(0);
    if (kind == FILTER_BOX) offset = 2.0 * u - 1.0;
    else if (kind == FILTER_TENT) offset = tentSample(u);
    else if (kind == FILTER_GAUSSIAN) offset = gaussianSample(u);
    else if (kind == FILTER_BLACKMAN_HARRIS) offset = vec2(blackmanHarrisSample(u.x), blackmanHarrisSample(u.y));
    return 0.5 + parameters.filterRadius * offset;
}

#endif
