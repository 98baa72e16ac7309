// Rough diffuse reflection: Oren and Nayar's qualitative model (SIGGRAPH 1994, eq. 30) with Fujii's s/t in
// place of max(0, cosφ) sinα tanβ, and the light that scatters between facets given back by the compensation
// of Portsmouth, Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF" (2024), here with Oren
// and Nayar's A and B rather than Fujii's, so that σ keeps its meaning.
//
//   f = ρ/π (A + B s/t) + ρms/π (1 − E(wo))(1 − E(wi)) / (1 − Eavg),  ρms = ρ² Eavg / (1 − ρ (1 − Eavg))
//   s = wo·wi − cosθo cosθi,  t = max(cosθo, cosθi) where s > 0, else 1
//
// Reciprocal; white (ρ = 1) reflects exactly what arrives. A single scattering event equals Oren and Nayar's
// where cosφ ≥ 0; behind (cosφ < 0) theirs stays at A, where Fujii's goes on to fall.
#ifndef OREN_NAYAR_GLSL
#define OREN_NAYAR_GLSL

// x: 1 − A, y: B; kept as the difference from 1, which survives small σ.
vec2 orenNayarTerms(float sigma) {
    float s2 = sigma * sigma;
    return vec2(0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
}

// ∫ cosθi s/t dωi / π (Portsmouth et al., the G of E_FON), written without dividing by cosθ.
float orenNayarIntegral(float cosTheta) {
    float s = sqrt(max(0.0, (1.0 - cosTheta) * (1.0 + cosTheta)));
    float theta = atan(s, cosTheta);
    return INV_PI * s * (theta - s * cosTheta + (2.0 / 3.0) * (cosTheta * (1.0 + s + s * s) / (1.0 + s) - 1.0));
}

// What Lambert's ρ / π is to be multiplied by. wo and wi on the same side.
vec3 orenNayarShape(vec3 rho, float sigma, vec3 wo, vec3 wi) {
    float zo = abs(wo.z), zi = abs(wi.z);
    vec2 t = orenNayarTerms(sigma);
    float s = dot(wo.xy, wi.xy);
    float single = 1.0 - t.x + t.y * (s > 0.0 ? s / max(zo, zi) : s);
    float lostOut = t.x - t.y * orenNayarIntegral(zo), lostIn = t.x - t.y * orenNayarIntegral(zi);
    float lostMean = t.x - t.y * (2.0 / 3.0 - 28.0 / 15.0 * INV_PI);  // cosine-weighted mean of the loss
    float again = max(lostOut, 0.0) / max(lostMean, 1e-37) * max(lostIn, 0.0);
    return vec3(single) + rho * (1.0 - lostMean) / (1.0 - rho * lostMean) * again;
}

#endif
