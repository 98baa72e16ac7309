// The Beckmann and Phong distributions of microfacets (Walter et al. 2007, section 5.2). Phong's exponent n
// is that of the Beckmann roughness α: n = 2/α² − 2, so that n + 2 = 2/α² is finite at both ends.
#ifndef BECKMANN_GLSL
#define BECKMANN_GLSL

// log(1 − x) with full relative precision near 0, for x in [0, 1).
float logOneMinus(float x) {
    return x < 0.02 ? -x * (1.0 + x * (0.5 + x * (1.0 / 3.0 + x * (0.25 + 0.2 * x)))) : log(1.0 - x);
}

// 1/sr. α along the tangent and the bitangent.
float beckmannD(vec3 h, vec2 alpha) {
    float z2 = h.z * h.z;
    if (!(z2 > 1e-12)) return 0.0;
    precise vec2 slope = h.xy / alpha;
    return exp(-(slope.x * slope.x + slope.y * slope.y) / z2) / (PI * alpha.x * alpha.y * z2 * z2);
}

// erfc(a) exp(a²), a ≥ 0: Abramowitz, Stegun 7.1.26, |error of erfc| ≤ 1.5e-7.
float erfcScaled(float a) {
    float t = 1.0 / (1.0 + 0.3275911 * a);
    return t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
}

// Smith's Λ of Beckmann, exact but for the error function, whose factor exp(−a²) leaves nothing to cancel for
// large a. Exactly 0, masking 1, at tanθ = 0.
float beckmannLambda(vec3 w, vec2 alpha) {
    float s = length(alpha * w.xy);
    float z = abs(w.z);
    if (!(s > 0.0) || z > 6.0 * s) return 0.0;
    if (!(z > 0.0)) return 1e30;
    float a = z / s;
    return max(0.5 * exp(-a * a) * (0.564189584 / a - erfcScaled(a)), 0.0);
}

// Smith's Λ of Phong. Walter et al. take Beckmann's, which for rough surfaces at grazing angles makes energy
// (albedo 1.5 at α = 1, cosθ = 0.05). Slopes of cosⁿθ are distributed as Student's t with ν = n + 2 degrees
// of freedom, so that
//   Λ = Γ((ν+1)/2) / (√π Γ(ν/2) (ν−1)) · sin^(ν−1)θ · tanθ − P(slope > cotθ),
// the tail by Wallace's normal approximation (1959, absolute error ≤ 2e-3). Narrow ones are Beckmann's.
float phongLambda(vec3 w, float alpha) {
    float sinSquared = dot(w.xy, w.xy);
    float z = abs(w.z);
    if (alpha < 0.1 || !(sinSquared > 0.0)) return beckmannLambda(w, vec2(alpha));
    if (!(z > 0.0)) return 1e30;
    float nu = 2.0 / (alpha * alpha);
    float logSine = 0.5 * log(min(sinSquared, 1.0));
    float q = 1.0 / nu;
    float gammas = sqrt(nu * (0.5 * INV_PI)) * (1.0 - q * (0.25 - q * (0.03125 + q * 0.0390625)));
    float first = gammas / (nu - 1.0) * exp((nu - 1.0) * logSine) * sqrt(sinSquared) / z;
    float y = (8.0 * nu + 1.0) / (8.0 * nu + 3.0) * sqrt(max(-nu * logSine, 0.0));
    return max(first - 0.5 * erfcScaled(y) * exp(-y * y), 0.0);
}

// cosⁿθ / (π α²), 1/sr.
float phongD(vec3 h, float alpha) {
    float a2 = alpha * alpha;
    precise float sinSquared = h.x * h.x + h.y * h.y;
    if (!(h.z > 0.0)) return 0.0;
    float logCosSquared = sinSquared < 0.02 ? logOneMinus(sinSquared) : 2.0 * log(h.z);
    return exp((1.0 - a2) / a2 * logCosSquared) / (PI * a2);
}

#endif
