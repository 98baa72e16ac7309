// Sheen of Burley 2012 (5.5): colour (1 − cosθd)⁵ on grazing retro-reflection, θd between h and the directions.
//
// Burley adds it to the base, which then gains energy. Here the base keeps 1 − max(colour) · E(wo) (sheen.glsl),
// and a strongly tinted colour (Burley's tint of pure blue is 13.8) is dimmed so that colour · E(0) ≤ 1.
#ifndef DISNEY_SHEEN_GLSL
#define DISNEY_SHEEN_GLSL

const float kDisneySheenLimit = 11.3;  // 1 / E(0)

vec3 disneySheenColor(vec3 baseColor, float metallic, float sheen, float tint) {
    float y = luminance(baseColor);
    vec3 hue = y > 0.0 ? baseColor / y : vec3(1);
    vec3 color = (sheen * (1.0 - metallic)) * mix(vec3(1), hue, tint);
    return color * min(1.0, kDisneySheenLimit / max(maxComponent(color), 1e-30));
}

// BSDF times cosine, 1/sr, of white; both directions above the surface.
float disneySheenEval(vec3 wo, vec3 wi) {
    float m = 1.0 - sqrt(max(0.5 + 0.5 * dot(wo, wi), 0.0));
    return m * m * m * m * m * abs(wi.z);
}

// ∫ of it over wi: a polynomial in 1 − cosθ fitted to quadrature; absolute error ≤ 2e-5. 0.0885 at grazing.
float disneySheenAlbedo(float cosTheta) {
    float x = 1.0 - abs(cosTheta);
    return 2.6505e-4 + x * (6.09311e-3 + x * (3.121281e-2 + x * (1.907903e-2 + x * (3.432197e-2 - x * 2.502827e-3))));
}

#endif
