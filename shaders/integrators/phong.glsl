// Phong's shading of glTF materials, for the integrators that do not trace paths: Lambert plus a normalised Phong
// lobe whose exponent fits the roughness (Walter et al. 2007: n = 2/α² − 2).
#ifndef PHONG_SHADING_GLSL
#define PHONG_SHADING_GLSL

struct PhongPoint {
    vec3 diffuse;    // albedo
    vec3 reflected;  // share that the surface reflects towards wo
    vec3 through;    // share that goes through it
    float exponent;
    float gloss;     // 1 a mirror, 0 matte: the share of `reflected` that is a mirror image
    float eta;       // index of the far side over the near one; 1 for panes
};

// `cosTheta` of wo.
PhongPoint phongAt(MaterialPoint m, bool frontFace, float cosTheta) {
    PhongPoint p;
    bool pane = (m.flags & MATERIAL_THIN) != 0u || m.transmission == 0.0;
    p.eta = frontFace || pane ? m.ior : 1.0 / m.ior;
    // (An index of 0 stands for F0 = 1.)
    vec3 dielectric = vec3(p.eta > 0.0 && !isinf(p.eta) ? fresnelDielectric(cosTheta, p.eta) : 1.0);
    if (has(FEATURE_SPECULAR_COLOR)) dielectric = min(dielectric * m.specularColor, vec3(1)) * m.specular;
    vec3 metal = fresnelSchlick(m.baseColor, cosTheta);
    if (has(FEATURE_CONDUCTOR) && (m.flags & MATERIAL_CONDUCTOR) != 0u)
        metal = fresnelConductor(cosTheta, m.conductorEta, m.conductorK);
    p.reflected = mix(dielectric, metal, m.metallic);
    vec3 entered = m.baseColor * (1.0 - m.metallic) * (1.0 - dielectric);
    p.diffuse = entered * (1.0 - m.transmission);
    p.through = entered * m.transmission;
    float alpha = max(m.alpha, 1e-2);
    p.exponent = clamp(2.0 / (alpha * alpha) - 2.0, 1.0, 2e4);
    p.gloss = 1.0 - sqrt(m.alpha);
    if (pane) p.eta = 1.0;
    return p;
}

// BRDF times cosine, 1/sr; directions in the shading frame, normal +z. `highlight`: share of `reflected` that shows as
// a lobe.
vec3 phongEval(PhongPoint p, vec3 wo, vec3 wi, float highlight) {
    if (wi.z <= 0.0) return vec3(0);
    float towards = max(dot(wo, vec3(-wi.xy, wi.z)), 0.0);
    // lint pow: the exponent is at least 1
    float lobe = highlight * (p.exponent + 2.0) * (0.5 * INV_PI) * pow(towards, p.exponent);
    return (p.diffuse * INV_PI + p.reflected * lobe) * wi.z;
}

#endif
