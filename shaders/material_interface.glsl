// Parameters of the interface between air and base, beyond those that every material has, read only under
// their features.
#ifndef MATERIAL_INTERFACE_GLSL
#define MATERIAL_INTERFACE_GLSL

float textured(float factor, uint index, uint channel, Surface s) {
    if (!has(FEATURE_TEXTURES) || index == NO_INDEX || factor == 0.0) return factor;
    return factor * sampleTexture(index, s.uv0, s.uv1)[channel];
}

// KHR_materials_specular and Disney's specularTint.
void readSpecular(Surface s, inout MaterialPoint m) {
    m.specular = textured(materialSpecular(s.material), materialSpecularTexture(s.material), 3u, s);
    m.specularColor = materialSpecularColor(s.material);
    uint colorTexture = materialSpecularColorTexture(s.material);
    if (has(FEATURE_TEXTURES) && colorTexture != NO_INDEX) m.specularColor *= sampleTexture(colorTexture, s.uv0, s.uv1).rgb;
    float tint = materialSpecularTint(s.material);
    float light = luminance(m.baseColor);
    if (tint > 0.0 && light > 0.0) m.specularColor *= mix(vec3(1), m.baseColor / light, tint);
}

// KHR_materials_anisotropy: the roughness along the direction of the grooves' reach.
void readAnisotropy(Surface s, inout MaterialPoint m) {
    float strength = textured(materialAnisotropy(s.material), materialAnisotropyTexture(s.material), 2u, s);
    if (strength > 0.0) m.alphaT = mix(m.alpha, 1.0, strength * strength);
}

void readIridescence(Surface s, inout MaterialPoint m) {
    m.iridescence = textured(materialIridescence(s.material), materialIridescenceTexture(s.material), 0u, s);
    m.iridescenceIor = materialIridescenceIor(s.material);
    uint thicknessTexture = materialIridescenceThicknessTexture(s.material);
    float share = thicknessTexture == NO_INDEX ? 1.0 : textured(1.0, thicknessTexture, 1u, s);
    m.iridescenceThickness =
        mix(materialIridescenceThicknessMinimum(s.material), materialIridescenceThicknessMaximum(s.material), share);
}

void readInterface(Surface s, inout MaterialPoint m) {
    if (has(FEATURE_SPECULAR_COLOR)) readSpecular(s, m);
    if (has(FEATURE_ANISOTROPY)) readAnisotropy(s, m);
    if (has(FEATURE_IRIDESCENCE)) readIridescence(s, m);
    if (has(FEATURE_CONDUCTOR) && (m.flags & MATERIAL_CONDUCTOR) != 0u) {
        m.conductorEta = materialConductorEta(s.material);
        m.conductorK = materialConductorK(s.material);
    }
}

#endif
