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
    uvec4 textures = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 6u);
    vec4 specular = materialTexel(s.material, 7u);
    m.specular = textured(specular.a, textures.y, 3u, s);
    m.specularColor = specular.rgb;
    if (has(FEATURE_TEXTURES) && textures.z != NO_INDEX) m.specularColor *= sampleTexture(textures.z, s.uv0, s.uv1).rgb;
    float tint = materialTexel(s.material, 8u).w;
    float light = luminance(m.baseColor);
    if (tint > 0.0 && light > 0.0) m.specularColor *= mix(vec3(1), m.baseColor / light, tint);
}

// KHR_materials_anisotropy: the roughness along the direction of the grooves' reach.
void readAnisotropy(Surface s, inout MaterialPoint m) {
    float strength = materialTexel(s.material, 11u).x;
    uint index = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 13u).x;
    strength = textured(strength, index, 2u, s);
    if (strength > 0.0) m.alphaT = mix(m.alpha, 1.0, strength * strength);
}

void readIridescence(Surface s, inout MaterialPoint m) {
    uvec4 textures = LOAD(materialTexels, s.material * MATERIAL_TEXELS + 13u);
    vec4 film = materialTexel(s.material, 12u);
    m.iridescence = textured(film.x, textures.y, 0u, s);
    m.iridescenceIor = film.y;
    float share = textures.z == NO_INDEX ? 1.0 : textured(1.0, textures.z, 1u, s);
    m.iridescenceThickness = mix(film.z, film.w, share);
}

void readInterface(Surface s, float dispersion, inout MaterialPoint m) {
    if (has(FEATURE_SPECULAR_COLOR)) readSpecular(s, m);
    if (has(FEATURE_ANISOTROPY)) readAnisotropy(s, m);
    if (has(FEATURE_IRIDESCENCE)) readIridescence(s, m);
    if (has(FEATURE_DISPERSION)) m.dispersion = dispersion;
    if (has(FEATURE_CONDUCTOR) && (m.flags & MATERIAL_CONDUCTOR) != 0u) {
        m.conductorEta = materialTexel(s.material, 15u).xyz;
        m.conductorK = materialTexel(s.material, 16u).xyz;
    }
}

#endif
