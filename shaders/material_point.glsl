// What a material is at one point of a surface, textures applied.
#ifndef MATERIAL_POINT_GLSL
#define MATERIAL_POINT_GLSL

struct MaterialPoint {
    vec3 baseColor;
    vec3 emission;
    float metallic;
    float alpha;  // microfacet α: perceptual roughness squared
    float ior;
    float transmission;
    vec3 absorption;
    uint flags;
    uint albedoTable;
};

#endif
