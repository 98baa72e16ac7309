// Which way light took to the camera, told by where the path scattered first.
#ifndef LIGHT_PATHS_GLSL
#define LIGHT_PATHS_GLSL

// Of light that was scattered last before the camera: the parts of a surface's diffuse base, of what came through it,
// and of fog. The rest is specular: what microfacets, coat and sheen reflect.
struct FirstScattering {
    vec3 diffuse, transmitted, volume;
};

FirstScattering noScattering() { return FirstScattering(vec3(0), vec3(0), vec3(0)); }
FirstScattering scatteredInFog() { return FirstScattering(vec3(0), vec3(0), vec3(1)); }

// (A GPU's quotient of equal numbers need not be 1.)
vec3 shareOf(vec3 part, vec3 whole) {
    vec3 share = mix(part / max(whole, vec3(1e-37)), vec3(1), greaterThanEqual(part, whole));
    return mix(vec3(0), share, greaterThan(whole, vec3(0)));
}

// Of the light `whole` that these parts belong to.
FirstScattering sharesOf(FirstScattering parts, vec3 whole) {
    return FirstScattering(shareOf(parts.diffuse, whole), shareOf(parts.transmitted, whole), shareOf(parts.volume, whole));
}

// Shares of the lobes in a direction that the BSDF was sampled for.
FirstScattering sharesAlong(Bsdf bsdf, vec3 wo, vec3 wi, bool delta) {
    if (wi.z < 0.0) return FirstScattering(vec3(0), vec3(1), vec3(0));
    if (delta) return noScattering();
    float pdf;
    vec3 diffuse, f = bsdfEvalParts(bsdf, wo, wi, pdf, diffuse);
    return FirstScattering(shareOf(diffuse, f), vec3(0), vec3(0));
}

// `scatterings`: between light and camera. Light that arrives after one is direct however it was found.
void splitLight(FirstScattering first, vec3 radiance, uint scatterings) {
    if (scatterings == 0u) {
        extra.light[LIGHT_PATH_EMISSION] += radiance;
        return;
    }
    vec3 diffuse = radiance * first.diffuse, transmitted = radiance * first.transmitted, volume = radiance * first.volume;
    uint indirect = scatterings == 1u ? 0u : 1u;
    extra.light[LIGHT_PATH_DIFFUSE + indirect] += diffuse;
    extra.light[LIGHT_PATH_TRANSMISSION + indirect] += transmitted;
    extra.light[LIGHT_PATH_VOLUME + indirect] += volume;
    extra.light[LIGHT_PATH_SPECULAR + indirect] += max(radiance - diffuse - transmitted - volume, 0.0);
}

#endif
