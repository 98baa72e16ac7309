// The sheen of cloth between coat and base, KHR_materials_sheen and Disney's, behind FEATURE_SHEEN and
// FEATURE_DISNEY_SHEEN; a sheen of colour 0 changes nothing. The base keeps 1 − E(wo) of the brightest channel.
//
// KHR_materials_sheen: the Charlie distribution with its own shadowing (Estevez, Kulla, "Production Friendly
// Microfacet Sheen BRDF", SIGGRAPH 2017 course notes), of the extension's two choices the fitted Λ rather than
// Ashikhmin's term; without their softened terminator, which is not reciprocal.
//
//   D = (2 + 1/α) sin^(1/α) θh / 2π,   f = D / (4 (1 + Λ(wo) + Λ(wi)) cosθo cosθi),   α = sheenRoughness²
//
// Λ is a fit, and for roughness below 0.25 the lobe reflects more than arrives at grazing angles (1.15 of it at
// 0.2, 6 at 0.03). There it is divided by max(1, E(wo), E(wi)), which keeps it reciprocal and at 1 or below.
// Roughness below 0.0316 (α 1e-3) is rendered as that: the lobe is all but gone but for the last few degrees.
#ifndef SHEEN_GLSL
#define SHEEN_GLSL

#include "disney_sheen.glsl"

float charlieL(float x, float alpha) {
    float t = (1.0 - alpha) * (1.0 - alpha);
    float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
    float d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(x, c)) + d * x + e;  // lint pow: c is at least 0.168
}

float charlieLambda(float cosTheta, float alpha) {
    if (cosTheta < 0.5) return exp(charlieL(cosTheta, alpha));
    return exp(2.0 * charlieL(0.5, alpha) - charlieL(max(1.0 - cosTheta, 1e-9), alpha));
}

// ln sin²θ from cosθ, without the cancellation that 1/α ≤ 1000 would magnify.
float logSinSquared(float cosTheta) {
    float c = cosTheta * cosTheta;
    return c < 0.02 ? -c * (1.0 + c * (1.0 / 2.0 + c * (1.0 / 3.0))) : log(max(1.0 - c, 1e-30));
}

float charlieD(float cosThetaH, float alpha) {
    return (2.0 + 1.0 / alpha) * exp(logSinSquared(cosThetaH) * 0.5 / alpha) * (0.5 * INV_PI);
}

const float kLeastSheenRoughness = 0.0316228;

// Directional albedo before the division. The table of worker/render/layer_tables.cpp has it times the roughness, of
// which it is nearly a constant at grazing angles, in rows whose roughness is that of `tableAlpha`'s root.
float charlieAlbedo(uint table, float cosTheta, float roughness) {
    float tableAlpha = (roughness - kLeastSheenRoughness) / (1.0 - kLeastSheenRoughness);
    return reflectionAlbedo(table, cosTheta, tableAlpha) / roughness;
}

// BSDF times cosine, 1/sr, of white; both directions above the surface.
float charlieEval(uint table, float roughness, vec3 wo, vec3 wi) {
    float alpha = roughness * roughness;
    float zo = max(wo.z, 1e-6), zi = max(wi.z, 1e-6);  // Λ no longer grows as 1/cosθ below
    vec3 h = wo + wi;
    float cosThetaH = h.z * inversesqrt(max(dot(h, h), 1e-30));
    float f = charlieD(cosThetaH, alpha) / (4.0 * (1.0 + charlieLambda(zo, alpha) + charlieLambda(zi, alpha)) * zo * zi);
    float gain = max(charlieAlbedo(table, zo, roughness), charlieAlbedo(table, zi, roughness));
    return f * wi.z / max(1.0, gain);
}

struct Sheen {
    vec3 color;       // Charlie's; 0: none
    float roughness;
    uint table;
    vec3 disney;      // Burley's; 0: none
};

Sheen sheenAt(MaterialPoint m, vec3 wo) {
    Sheen s;
    s.color = has(FEATURE_SHEEN) ? m.sheenColor : vec3(0);
    s.roughness = clamp(m.sheenRoughness, kLeastSheenRoughness, 1.0);
    s.table = m.sheenTable;
    s.disney = vec3(0);
    if (has(FEATURE_DISNEY_SHEEN) && m.disneySheen > 0.0)
        s.disney = disneySheenColor(m.baseColor, m.metallic, m.disneySheen, m.disneySheenTint);
    return s;
}

bool hasCharlie(Sheen s) { return has(FEATURE_SHEEN) && maxComponent(s.color) > 0.0; }
bool hasDisneySheen(Sheen s) { return has(FEATURE_DISNEY_SHEEN) && maxComponent(s.disney) > 0.0; }

// Directional albedo of both lobes together, before it is kept at 1 or below.
vec3 sheenSum(Sheen s, float cosTheta) {
    vec3 sum = vec3(0);
    if (hasCharlie(s)) sum += s.color * min(charlieAlbedo(s.table, cosTheta, s.roughness), 1.0);
    if (hasDisneySheen(s)) sum += s.disney * disneySheenAlbedo(cosTheta);
    return sum;
}

// Share of light from wo that the sheen keeps from the base.
float sheenAlbedo(Sheen s, vec3 wo) { return min(maxComponent(sheenSum(s, wo.z)), 1.0); }

// BSDF times cosine, 1/sr. wi above the surface.
vec3 sheenEval(Sheen s, vec3 wo, vec3 wi) {
    vec3 f = vec3(0);
    if (hasCharlie(s)) f += s.color * charlieEval(s.table, s.roughness, wo, wi);
    if (!hasDisneySheen(s)) return f;
    f += s.disney * disneySheenEval(wo, wi);
    return f / max(1.0, max(maxComponent(sheenSum(s, wo.z)), maxComponent(sheenSum(s, wi.z))));
}

// Charlie by uniform directions, as the authors advise: it peaks at the rim of the hemisphere, where
// cosine-weighted ones are rarest (relative variance of a weight at roughness 0.1, grazing: 3.5 against 31).
float sheenPdf(Sheen s, vec3 wi) { return hasCharlie(s) ? 0.5 * INV_PI : cosinePdf(wi); }

vec3 sheenSample(Sheen s, vec2 u) {
    if (!hasCharlie(s)) return cosineHemisphere(u);
    float z = 1.0 - u.x;  // (0, 1]
    float r = sqrt(max(0.0, (1.0 - z) * (1.0 + z)));
    float phi = TWO_PI * u.y;
    return vec3(r * cos(phi), r * sin(phi), z);
}

#endif
