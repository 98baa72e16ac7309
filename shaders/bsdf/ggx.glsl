// The GGX distribution of microfacets with Smith's masking (Walter et al. 2007, Heitz 2014). Directions in
// the shading frame; h on the side of +z. Everything but D depends on α through "stretched" directions, so
// the anisotropic forms take the stretch of the tangent and that of the bitangent.
#ifndef GGX_GLSL
#define GGX_GLSL

// Normals per solid angle, 1/sr: α² / (π (α² cos² + sin²)²). sin² comes from x and y: 1 − cos² would
// lose all digits for small α, and `precise` keeps the compiler from going back to it.
float ggxD(vec3 h, float alpha) {
    precise float a2 = alpha * alpha;
    precise float s = a2 * h.z * h.z + (h.x * h.x + h.y * h.y);
    return a2 / max(PI * s * s, 1e-37);
}

float ggxD(vec3 h, vec2 alpha) {
    precise float ax = alpha.x * alpha.x, ay = alpha.y * alpha.y;
    // Times αx αy: 1 / (π αx αy (…)²) without a quotient that overflows.
    precise float s = ax * ay * h.z * h.z + (ay * (h.x * h.x) + ax * (h.y * h.y));
    return ax * ay * (alpha.x * alpha.y) / max(PI * s * s, 1e-37);
}

// sqrt(cos² + α² sin²), from which all of Smith's terms follow without dividing by cosθ.
float ggxStretch(vec3 w, float alpha) { return sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }
float ggxStretch(vec3 w, vec2 alpha) { return length(vec3(alpha * w.xy, w.z)); }

// Share of microfacets that w sees. Exactly 1 at normal incidence.
float ggxG1(vec3 w, float alpha) {
    float z = abs(w.z);
    float sum = z + ggxStretch(w, alpha);
    return sum > 0.0 ? 2.0 * z / sum : 0.0;
}

// Height-correlated masking and shadowing over 4 cosθo cosθi, 1/sr free of both cosines. `so`, `si`: the
// directions' stretches.
float ggxVisibility(float zo, float zi, float so, float si) { return 0.5 / max(zo * si + zi * so, 1e-30); }
float ggxVisibility(vec3 wo, vec3 wi, float alpha) {
    return ggxVisibility(abs(wo.z), abs(wi.z), ggxStretch(wo, alpha), ggxStretch(wi, alpha));
}

// Density of visible normals, 1/sr: G1 D |wo·h| / cosθo.
float ggxVisiblePdf(vec3 wo, vec3 h, float alpha) {
    float sum = abs(wo.z) + ggxStretch(wo, alpha);
    return sum > 0.0 ? 2.0 * ggxD(h, alpha) * abs(dot(wo, h)) / sum : 0.0;
}

// Visible normals by spherical caps (Dupuy, Benyoub 2023). wo.z ≥ 0. Density G1 D |wo·h| / cosθo.
vec3 ggxSampleVisible(vec3 wo, vec2 alpha, vec2 u) {
    vec3 stretched = normalize(vec3(alpha * wo.xy, wo.z));
    float phi = TWO_PI * u.x;
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float r = sqrt(clamp((1.0 - z) * (1.0 + z), 0.0, 1.0));
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + stretched;
    h = vec3(alpha * h.xy, max(h.z, 0.0));
    float squared = dot(h, h);
    return squared > 0.0 ? h * inversesqrt(squared) : vec3(0, 0, 1);
}
vec3 ggxSampleVisible(vec3 wo, float alpha, vec2 u) { return ggxSampleVisible(wo, vec2(alpha), u); }

#endif
