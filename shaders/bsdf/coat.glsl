// The clearcoat above all other lobes: KHR_materials_clearcoat. Behind FEATURE_CLEARCOAT; a coat of
// weight 0 changes nothing.
#ifndef COAT_GLSL
#define COAT_GLSL

struct Coat {
    float weight;   // 0: none
    float alpha;    // microfacet α
    vec3 normal;    // of the coat, in the shading frame of the base
};

Coat coatAt(MaterialPoint m, vec3 wo) { return Coat(0.0, 0.0, vec3(0, 0, 1)); }

// Share of light from wo that the coat keeps from what lies below: its directional albedo. View-only, so
// that a white stack returns all light.
float coatAlbedo(Coat c, vec3 wo) { return 0.0; }

// A delta lobe: coatEval is then not asked, and coatSample gives the mirror direction.
bool coatIsMirror(Coat c) { return false; }

// BSDF times cosine, 1/sr, with the weight.
vec3 coatEval(Coat c, vec3 wo, vec3 wi) { return vec3(0); }

// Solid-angle pdf of wi, 1/sr, as coatSample draws.
float coatPdf(Coat c, vec3 wo, vec3 wi) { return 0.0; }

// False where no light goes. `colour`: for a mirror, its reflectance with the weight.
bool coatSample(Coat c, vec3 wo, vec2 u, out vec3 wi, out vec3 colour) {
    wi = vec3(0);
    colour = vec3(0);
    return false;
}

#endif
