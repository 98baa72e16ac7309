// Solids within solids: the materials that a ray is inside of, innermost first, NO_INDEX where there is none. A solid is
// pushed where the ray enters and taken out where it leaves, wherever it stands; the one entered last is what the ray is
// in. So solids that overlap have no order of their own: the one that a ray enters later goes on where it leaves the
// earlier one, and that surface is not seen from there.
#ifndef MEDIA_STACK_GLSL
#define MEDIA_STACK_GLSL

// By data as well: a kernel may hold this code for a scene without such solids.
bool mediaNest() { return has(FEATURE_NESTED_MEDIA) && parameters.mediaNest != 0u; }

bool isFull(uvec4 stack) { return stack.w != NO_INDEX; }

uvec4 withMedium(uvec4 stack, uint material) { return uvec4(material, stack.xyz); }

// Without the innermost solid of that material; the same where there is none.
uvec4 withoutMedium(uvec4 stack, uint material) {
    if (stack.x == material) return uvec4(stack.yzw, NO_INDEX);
    if (stack.y == material) return uvec4(stack.x, stack.zw, NO_INDEX);
    if (stack.z == material) return uvec4(stack.xy, stack.w, NO_INDEX);
    if (stack.w == material) return uvec4(stack.xyz, NO_INDEX);
    return stack;
}

// Index of refraction of a solid for the colour channel that a path follows (3: all).
float solidIor(uint material, uint channel) {
    float ior = materialIor(material);
    if (ior == 0.0) return 1.5;  // KHR_materials_specular's mirror; what is refracted takes this (bsdf/interface.glsl)
    if (has(FEATURE_DISPERSION) && channel < 3u) return dispersedIor(ior, materialDispersion(material), channel);
    return ior;
}

// Makes a material's index of refraction relative to what is outside of its surface. Rough glass goes without energy
// compensation then, whose tables are for glass in air.
void setRelativeIor(uvec4 stack, Surface s, uint channel, inout MaterialPoint m) {
    bool solid = (m.flags & MATERIAL_THIN) == 0u && (m.transmission > 0.0 || m.diffuseTransmission > 0.0);
    bool leaves = solid && !s.frontFace;
    uint around = leaves ? withoutMedium(stack, s.material).x : stack.x;
    if (around == NO_INDEX || m.ior == 0.0 || (m.flags & MATERIAL_INTERFACE) == 0u) return;
    m.ior = leaves && stack.x != s.material ? 1.0 : m.ior / solidIor(around, channel);
    if (m.transmission == 1.0) m.albedoTable = NO_INDEX;
}

#endif
