// Iridescence of a thin film on dielectrics and metals: KHR_materials_iridescence, which is Belcour, Barla
// 2017 ("A practical extension to microfacet theory for the modeling of varying iridescence") with Schlick's
// curve for both of the film's interfaces. Interference is summed over the first orders, each integrated
// against the colour matching functions as Gaussians of the optical path difference.
#ifndef THIN_FILM_GLSL
#define THIN_FILM_GLSL

// Linear Rec. 709 response to a cosine of the wave number, of an optical path difference in nm and a phase
// shift, relative to white.
vec3 filmSensitivity(float difference, vec3 shift) {
    float phase = TWO_PI * difference * 1e-9;
    const vec3 value = vec3(5.4856e-13, 4.4201e-13, 5.2481e-13);
    const vec3 position = vec3(1.6810e+06, 1.7953e+06, 2.2084e+06);
    const vec3 variance = vec3(4.3278e+09, 9.3046e+09, 6.6121e+09);
    vec3 xyz = value * sqrt(TWO_PI * variance) * cos(position * phase + shift) * exp(-(phase * phase) * variance);
    xyz.x += 9.7470e-14 * sqrt(TWO_PI * 4.5282e+09) * cos(2.2399e+06 * phase + shift.x) * exp(-4.5282e+09 * phase * phase);
    const mat3 toRec709 = mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252);
    return toRec709 * (xyz / 1.0685e-7);
}

// Reflectance at an outer angle. `base`: of what lies under the film, at normal incidence without it.
// In [0, 1]: what Gaussians and gamut leave outside is cut off.
vec3 filmReflectance(float cosTheta, float filmIor, float thickness, vec3 base) {
    // A film thinner than light can resolve fades into air.
    float ior = mix(1.0, filmIor, smoothstep(0.0, 0.03, thickness));
    float sinSquared2 = (1.0 - cosTheta) * (1.0 + cosTheta) / (ior * ior);
    float cosSquared2 = 1.0 - sinSquared2;
    if (cosSquared2 <= 0.0) return vec3(1);
    float cos2 = sqrt(cosSquared2);

    float r12 = mix(fresnelNormal(ior), 1.0, schlickWeight(cosTheta));
    float t121 = 1.0 - r12;
    vec3 root = sqrt(clamp(base, 0.0, 0.9999));
    vec3 baseIor = (1.0 + root) / (1.0 - root);
    vec3 ratio = (baseIor - ior) / (baseIor + ior);
    vec3 r23 = fresnelSchlick(ratio * ratio, cos2);
    // A reflection off the denser side turns the phase.
    vec3 shift = mix(vec3(0), vec3(PI), lessThan(baseIor, vec3(ior))) + (ior < 1.0 ? 0.0 : PI);

    float difference = 2.0 * ior * thickness * cos2;
    vec3 r123 = clamp(r12 * r23, 1e-5, 0.9999);
    vec3 amplitude = sqrt(r123);
    vec3 rs = t121 * t121 * r23 / (1.0 - r123);
    vec3 sum = r12 + rs;
    vec3 order = rs - t121;
    for (int m = 1; m <= 2; m++) {
        order *= amplitude;
        sum += order * (2.0 * filmSensitivity(float(m) * difference, float(m) * shift));
    }
    return clamp(sum, 0.0, 1.0);
}

// Bound on the reflectance at normal incidence of any thickness: both interfaces' amplitudes in phase. A red of Rec. 709
// swings by up to 2.1 times as much around the mean, since its response is negative where blue and green are; the others
// by 1.1 times. (Measured over indices from 1 to 3, bases up to 0.95 and all thicknesses up to 2000 nm.)
vec3 filmEnvelope(float filmIor, vec3 base) {
    float first = sqrt(fresnelNormal(filmIor));
    vec3 root = sqrt(clamp(base, 0.0, 0.9999));
    vec3 baseIor = (1.0 + root) / (1.0 - root);
    vec3 second = abs(baseIor - filmIor) / (baseIor + filmIor);
    vec3 product = first * second;
    vec3 amplitude = (first + second) / (1.0 + product);
    float r12 = first * first, t12 = 1.0 - r12;
    vec3 mean = r12 + t12 * t12 * second * second / (1.0 - product * product);
    return min(mean + vec3(2.2, 1.12, 1.12) * (amplitude * amplitude - mean) + vec3(0.012, 0.007, 0.007), 1.0);
}

#endif
