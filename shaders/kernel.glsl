// What the kernel of every integrator has: the scene, rays through it, materials, lights, camera and film.
#ifndef KERNEL_GLSL
#define KERNEL_GLSL

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform PassBlock { PassConstants pass; };
layout(std430, binding = BINDING_TILES) readonly buffer Tiles { uvec4 tiles[]; };
layout(std430, binding = BINDING_FILM) buffer Film { vec4 film[]; };
layout(std430, binding = BINDING_COUNTERS) buffer Counters { uint counters[]; };
#include "counters.glsl"

uint rayCount = 0u;
// Of paths, see TILE_* in gpu_types.h.
uint rejectedCount = 0u, truncatedCount = 0u, clampedCount = 0u, behindGlassCount = 0u;
ExactSum truncatedThroughput = ExactSum(0u, 0u), clampedRadiance = ExactSum(0u, 0u);

bool acceptHit(uint primitive, vec2 barycentrics, uint key);
#include "intersect.glsl"
#include "texture.glsl"
#include "surface.glsl"
#include "material.glsl"

#include "bsdf/bsdf.glsl"
#include "lights/light.glsl"
#include "camera.glsl"
#include "coincident.glsl"
#include "pixel_filter.glsl"
#include "film.glsl"
#include "extra_channels.glsl"

// What decides at cut-out surfaces along the rays of a bounce.
uint cutoutKey(SampleKey key, uint bounce) {
    return has(FEATURE_CUTOUT) ? randomBits(key, bounceDimension(bounce, DIMENSION_CUTOUT)).x : 0u;
}

// Likewise of shadow rays: what the path's own ray came through, light may not.
uint shadowKey(SampleKey key, uint bounce) { return ~cutoutKey(key, bounce); }

// From a surface to the sample of a light; its t counts in the length of that way.
Ray shadowRay(LightSample l, Surface s, uint key) {
    // Not the light itself: traversal has its t to within γ(10), and a light in a plane through the origin has no error
    // of its own that would move the target off it.
    float tMax = l.infinite ? INFINITY : 1.0 - gammaBound(10.0);
    Ray ray = freeRay(l.origin, l.infinite ? l.wi : l.target - l.origin, tMax, key);
    startOn(s, ray);
    ray.culls = cullsAll();
    return ray;
}

// Something stands in a light's way. Through smooth solid glass no path finds a light without extent.
void noteShadow(LightSample l, uint primitive) {
    if (!has(FEATURE_TRANSMISSION) || !has(FEATURE_PUNCTUAL_LIGHTS) || l.pdf > 0.0) return;
    if ((materialFlags(loadPrimitive(primitive).material) & MATERIAL_SOLID_GLASS) != 0u) behindGlassCount++;
}

bool occluded(LightSample l, Surface s, uint key) {
    rayCount++;
    Ray ray = shadowRay(l, s, key);
    Hit next;
    uint other;
    if (nextAmongFaces(s, ray.direction, key, next))
        other = next.primitive;
    else if (!anyHit(ray, other))
        return false;
    noteShadow(l, other);
    return true;
}

#endif
