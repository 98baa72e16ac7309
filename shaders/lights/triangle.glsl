// Emissive triangles, sampled uniformly by area.
#ifndef TRIANGLE_LIGHT_GLSL
#define TRIANGLE_LIGHT_GLSL

// Solid-angle pdf, 1/sr, of a point chosen uniformly on `area` at squared distance and cosine.
float areaToSolidAngle(float area, float distanceSquared, float cosine) {
    return cosine > 0.0 ? distanceSquared / (cosine * area) : 0.0;
}

// Radiance that a primitive's material sends towards wo, given which side wo sees.
bool emitsTowards(uint flags, bool frontFace) { return frontFace || (flags & MATERIAL_DOUBLE_SIDED) != 0u; }

#endif
