// The GGX distribution of microfacets with Smith's masking, isotropic. Directions in the shading
// frame; h on the side of +z.
#ifndef GGX_GLSL
#define GGX_GLSL

// Normals per solid angle, 1/sr: α² / (π (α² cos² + sin²)²). sin² comes from x and y: 1 − cos² would
// lose all digits for small α, and `precise` keeps the compiler from going back to it.
float ggxD(vec3 h, float alpha) {
    precise float a2 = alpha * alpha;
    precise float s = a2 * h.z * h.z + (h.x * h.x + h.y * h.y);
    return a2 / max(PI * s * s, 1e-37);
}

// sqrt(cos² + α² sin²), from which all of Smith's terms follow without dividing by cosθ.
float ggxStretch(vec3 w, float alpha) { return sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }

// Share of microfacets that w sees. Exactly 1 at normal incidence.
float ggxG1(vec3 w, float alpha) {
    float z = abs(w.z);
    float sum = z + ggxStretch(w, alpha);
    return sum > 0.0 ? 2.0 * z / sum : 0.0;
}

// Height-correlated masking and shadowing over 4 cosθo cosθi, 1/sr free of both cosines.
float ggxVisibility(vec3 wo, vec3 wi, float alpha) {
    float sum = abs(wo.z) * ggxStretch(wi, alpha) + abs(wi.z) * ggxStretch(wo, alpha);
    return 0.5 / max(sum, 1e-30);
}

// Height-correlated G2(wo, wi) / G1(wo): the weight of a direction sampled by visible normals.
float ggxShadowing(vec3 wo, vec3 wi, float alpha) {
    float zo = abs(wo.z), zi = abs(wi.z);
    float so = ggxStretch(wo, alpha), si = ggxStretch(wi, alpha);
    float sum = zo * si + zi * so;
    return sum > 0.0 ? zi * (zo + so) / sum : 0.0;
}

// Density of visible normals, 1/sr: G1 D |wo·h| / cosθo.
float ggxVisiblePdf(vec3 wo, vec3 h, float alpha) {
    float sum = abs(wo.z) + ggxStretch(wo, alpha);
    return sum > 0.0 ? 2.0 * ggxD(h, alpha) * abs(dot(wo, h)) / sum : 0.0;
}

// Visible normals by spherical caps (Dupuy, Benyoub 2023). wo.z ≥ 0.
vec3 ggxSampleVisible(vec3 wo, float alpha, vec2 u) {
    vec3 stretched = normalize(vec3(alpha * wo.xy, wo.z));
    float phi = TWO_PI * u.x;
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float r = sqrt(clamp((1.0 - z) * (1.0 + z), 0.0, 1.0));
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + stretched;
    h = vec3(alpha * h.xy, max(h.z, 0.0));
    float squared = dot(h, h);
    return squared > 0.0 ? h * inversesqrt(squared) : vec3(0, 0, 1);
}

#endif
