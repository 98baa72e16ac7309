// Reflectance of smooth interfaces.
#ifndef FRESNEL_GLSL
#define FRESNEL_GLSL

// Exact Fresnel for unpolarised light between dielectrics. cosθ ≥ 0 on the incident side; `eta` is
// the index of the far side over the near side. 1 beyond the critical angle. Written with the
// difference of squares in factors so that R + T = 1 holds at the critical angle itself.
float fresnelDielectric(float cosTheta, float eta) {
    if (eta == 1.0) return 0.0;
    cosTheta = clamp(cosTheta, 0.0, 1.0);
    float sinSquared = (1.0 - cosTheta) * (1.0 + cosTheta);
    float cosSquaredT = 1.0 - sinSquared / (eta * eta);
    if (cosSquaredT <= 0.0) return 1.0;
    float cosT = sqrt(cosSquaredT);
    float parallel = (eta * cosTheta - cosT) / (eta * cosTheta + cosT);
    float perpendicular = (cosTheta - eta * cosT) / (cosTheta + eta * cosT);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// (1 − cosθ)⁵, by which Schlick's curve (1994) goes from F0 to 1.
float schlickWeight(float cosTheta) {
    float m = clamp(1.0 - cosTheta, 0.0, 1.0);
    float m2 = m * m;
    return m2 * m2 * m;
}

// Schlick's curve, glTF's model of metals: `f0` at normal incidence, 1 at grazing.
vec3 fresnelSchlick(vec3 f0, float cosTheta) { return f0 + (1.0 - f0) * schlickWeight(cosTheta); }

// Reflectance at normal incidence.
float fresnelNormal(float eta) {
    float r = (eta - 1.0) / (eta + 1.0);
    return r * r;
}

// Schlick's curve for dielectrics. From the dense side it runs over the angle beyond the interface, so
// that it meets 1 at the critical angle.
float fresnelDielectricSchlick(float cosTheta, float eta) {
    if (eta == 1.0) return 0.0;
    float f0 = fresnelNormal(eta);
    if (eta < 1.0) {
        float sinSquared = (1.0 - cosTheta) * (1.0 + cosTheta);
        float cosSquaredT = 1.0 - sinSquared / (eta * eta);
        if (cosSquaredT <= 0.0) return 1.0;
        cosTheta = sqrt(cosSquaredT);
    }
    return f0 + (1.0 - f0) * schlickWeight(cosTheta);
}

// Exact Fresnel between vacuum and a metal of index η + i k, one colour channel (Born, Wolf: Principles of
// Optics, 14.2; Lagarde 2013). The real part of the root is taken from the sum that does not cancel, so
// that k = 0 and n < 1 (total reflection by "n < 1" glass) stay finite and ≤ 1.
float fresnelConductor(float cosTheta, float eta, float k) {
    cosTheta = clamp(cosTheta, 0.0, 1.0);
    float cos2 = cosTheta * cosTheta;
    float sin2 = (1.0 - cosTheta) * (1.0 + cosTheta);
    // η² − k² − sin², of which the grazing half goes by 1 − cos²: an index near vacuum's keeps its digits there.
    float t0 = cos2 < 0.5 ? ((eta - 1.0) * (eta + 1.0) - k * k) + cos2 : (eta - k) * (eta + k) - sin2;
    float cross2 = 4.0 * eta * eta * k * k;
    float modulus = sqrt(t0 * t0 + cross2);  // |a + ib|² of the complex cosine beyond the interface
    float twiceA2 = t0 >= 0.0 ? modulus + t0 : (modulus - t0 > 0.0 ? cross2 / (modulus - t0) : 0.0);
    float ac = sqrt(2.0 * twiceA2) * cosTheta;  // 2 a cosθ
    float sumS = modulus + cos2, sumP = modulus * cos2 + sin2 * sin2;
    float acs = ac * sin2;
    float s = sumS + ac > 0.0 ? (sumS - ac) / (sumS + ac) : 1.0;
    float p = sumP + acs > 0.0 ? (sumP - acs) / (sumP + acs) : 1.0;
    return clamp(0.5 * s * (1.0 + p), 0.0, 1.0);
}

vec3 fresnelConductor(float cosTheta, vec3 eta, vec3 k) {
    return vec3(fresnelConductor(cosTheta, eta.r, k.r), fresnelConductor(cosTheta, eta.g, k.g), fresnelConductor(cosTheta, eta.b, k.b));
}

// The angle whose Schlick weight is its cosine-weighted mean, 1/21: there any curve near Schlick's has
// about its average 2 ∫ F cosθ dcosθ.
const float FRESNEL_AVERAGE_COSINE = 0.456023;

// Cosine-weighted average of fresnelDielectric for eta ≥ 1 (Kulla, Conty 2017, a fit to 1e-3).
float fresnelDielectricAverage(float eta) { return (eta - 1.0) / (4.08567 + 1.00071 * eta); }

#endif
