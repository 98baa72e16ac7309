// Burley's clearcoat distribution (2012, appendix B.2): generalised Trowbridge-Reitz with exponent 1, whose
// tail is longer than GGX's, and his masking term, Smith's for GGX with α = 0.25 whatever the coat's own.
#ifndef GTR1_GLSL
#define GTR1_GLSL

// α below Burley's glossiest is rendered as that.
float gtr1Alpha(float alpha) { return clamp(alpha, 1e-3, 1.0); }

// (α² − 1) / ln α², which tends to 1.
float gtr1Norm(float alpha) {
    float x = (alpha - 1.0) * (alpha + 1.0);
    if (x > -0.05) return 1.0 / (1.0 - x * (1.0 / 2.0 - x * (1.0 / 3.0 - x * (1.0 / 4.0 - x * (1.0 / 5.0)))));
    return x / (2.0 * log(alpha));
}

// Normals per solid angle, 1/sr: (α² − 1) / (π ln α² (1 + (α² − 1) cos²)). sin² comes from x and y, see ggxD.
float gtr1D(vec3 h, float alpha) {
    precise float s = alpha * alpha * h.z * h.z + (h.x * h.x + h.y * h.y);
    return gtr1Norm(alpha) / max(PI * s, 1e-37);
}

// Masking and shadowing over 4 cosθo cosθi.
float gtr1Visibility(vec3 wo, vec3 wi) {
    float zo = abs(wo.z), zi = abs(wi.z);
    const float a2 = 0.0625;
    float so = sqrt(zo * zo + a2 * (wo.x * wo.x + wo.y * wo.y)), si = sqrt(zi * zi + a2 * (wi.x * wi.x + wi.y * wi.y));
    return 1.0 / ((zo + so) * (zi + si));
}

// Normals with the density D cosθh: cos²θh = (1 − α^(2 − 2u)) / (1 − α²), with sin² not taken from it.
vec3 gtr1SampleNormal(float alpha, vec2 u) {
    float a2 = alpha * alpha;
    // lint pow: gtr1Alpha keeps α² at 1e-6 or above
    float sinSquared = 1.0 - a2 > 1e-3 ? (pow(a2, 1.0 - u.x) - a2) / (1.0 - a2) : u.x;
    sinSquared = clamp(sinSquared, 0.0, 1.0);
    float r = sqrt(sinSquared), phi = TWO_PI * u.y;
    return vec3(r * cos(phi), r * sin(phi), sqrt(1.0 - sinSquared));
}

#endif
