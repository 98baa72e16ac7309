// The sheen of cloth between coat and base: KHR_materials_sheen and Disney's. Behind FEATURE_SHEEN and
// FEATURE_DISNEY_SHEEN; a sheen of colour 0 changes nothing.
#ifndef SHEEN_GLSL
#define SHEEN_GLSL

struct Sheen {
    vec3 color;  // 0: none
    float roughness;
};

Sheen sheenAt(MaterialPoint m, vec3 wo) { return Sheen(vec3(0), 0.0); }

// Share of light from wo that the sheen keeps from the base.
float sheenAlbedo(Sheen s, vec3 wo) { return 0.0; }

// BSDF times cosine, 1/sr. Sampled by a cosine lobe on wo's side.
vec3 sheenEval(Sheen s, vec3 wo, vec3 wi) { return vec3(0); }

#endif
