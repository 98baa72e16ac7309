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

// Schlick's curve, glTF's model of metals: `f0` at normal incidence, 1 at grazing.
vec3 fresnelSchlick(vec3 f0, float cosTheta) {
    float m = clamp(1.0 - cosTheta, 0.0, 1.0);
    float m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

#endif
