// Diffuse reflection of Burley, "Physically-Based Shading at Disney" (SIGGRAPH 2012 course notes, 5.3):
// Lambert times a retro-reflective factor that follows roughness, and its `subsurface` blend towards an
// approximation of Hanrahan and Krueger (1993) for flat surfaces.
//
//   F_d  = (1 + (F90 − 1)(1 − cosθi)⁵) (1 + (F90 − 1)(1 − cosθo)⁵),  F90 = 1/2 + 2 roughness cos²θd
//   ss   = 1.25 (F_ss (1 / (cosθi + cosθo) − 1/2) + 1/2),            F_ss the same with F90 = roughness cos²θd
//
// Both reflect more than arrives at grazing angles (up to 1.56 of it for F_d, 1.51 for ss). Where that is so
// the value is divided by the larger of the two directional albedos, max(1, E(wo), E(wi)): reciprocal, never
// above 1, and Burley's own formula to the bit wherever neither direction gains energy.
#ifndef DISNEY_DIFFUSE_GLSL
#define DISNEY_DIFFUSE_GLSL

float fifthPower(float x) { return x * x * x * x * x; }

// ∫ cosθi (1 + a (1 − l)⁵)(1 + a (1 − v)⁵) g(l) dωi / π with a = p + q cos²θd, averaged over φ, from the
// moments of the weight g: k = 2 ∫ (l, l²) g dl, m = 2 ∫ (l, l², l³)(1 − l)⁵ g dl, where l = cosθi, v = cosθo.
float burleyIntegral(float p, float q, float v, vec2 k, vec3 m) {
    float grazing = fifthPower(1.0 - v);
    vec2 mean = vec2(p + 0.5 * q, 0.5 * q * v);  // of a, in powers of l
    float half_ = 0.5 * (1.0 - v) * (1.0 + v);
    vec3 square = vec3(p * p + p * q + 0.25 * q * q * (1.0 + half_), (p + 0.5 * q) * q * v, 0.25 * q * q * (v * v - half_));
    return k.x + dot(mean, m.xy + grazing * k) + grazing * dot(square, m);
}

// Directional albedo of F_d over π: exact.
float disneyRetroAlbedo(float roughness, float v) {
    return burleyIntegral(-0.5, 2.0 * roughness, v, vec2(1.0, 2.0 / 3.0), vec3(1.0 / 21.0, 1.0 / 84.0, 1.0 / 252.0));
}

// Directional albedo of ss over π: exact. The moments of 1 / (l + v) follow from the logarithm by recurrences
// that shrink their own rounding errors, or grow them 32-fold at most.
float disneyFlatAlbedo(float roughness, float v) {
    v = max(v, 1e-7);
    float n = log((1.0 + v) / v);
    float k1 = 1.0 - v * n;
    float k2 = 0.5 - v * k1;
    for (int j = 1; j <= 5; j++) n = (1.0 + v) * n - 1.0 / float(j);  // ∫ (1 − l)^j / (l + v) dl
    float m1 = 1.0 / 6.0 - v * n;
    float m2 = 1.0 / 42.0 - v * m1;
    float m3 = 1.0 / 168.0 - v * m2;
    float inverse = burleyIntegral(-1.0, roughness, v, 2.0 * vec2(k1, k2), 2.0 * vec3(m1, m2, m3));
    float plain = burleyIntegral(-1.0, roughness, v, vec2(1.0, 2.0 / 3.0), vec3(1.0 / 21.0, 1.0 / 84.0, 1.0 / 252.0));
    return 1.25 * (inverse - 0.5 * plain + 0.5);
}

float disneyDiffuseAlbedo(float roughness, float subsurface, float cosTheta) {
    float albedo = disneyRetroAlbedo(roughness, cosTheta);
    return subsurface > 0.0 ? mix(albedo, disneyFlatAlbedo(roughness, cosTheta), subsurface) : albedo;
}

// What Lambert's albedo / π is to be multiplied by. wo and wi on the same side.
float disneyDiffuseShape(float roughness, float subsurface, vec3 wo, vec3 wi) {
    float v = abs(wo.z), l = abs(wi.z);
    float cosSquared = 0.5 + 0.5 * dot(wo, wi);
    float gv = fifthPower(1.0 - v), gl = fifthPower(1.0 - l);
    float retro = 2.0 * roughness * cosSquared - 0.5;
    float shape = (1.0 + retro * gl) * (1.0 + retro * gv);
    if (subsurface > 0.0) {
        float flat_ = roughness * cosSquared - 1.0;
        float fss = (1.0 + flat_ * gl) * (1.0 + flat_ * gv);
        shape = mix(shape, 1.25 * (fss * (1.0 / max(l + v, 1e-7) - 0.5) + 0.5), subsurface);
    }
    float gain = max(disneyDiffuseAlbedo(roughness, subsurface, v), disneyDiffuseAlbedo(roughness, subsurface, l));
    return shape / max(1.0, gain);
}

#endif
