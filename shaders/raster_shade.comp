#version 460
// Colours what the raster pipeline saw: Phong's shading by lights that nothing hides, the environment's irradiance and
// its mirror image. An instant preview, the cheap end of the scale of accuracy.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#include "kernel.glsl"
#include "integrators/ambient.glsl"
#include "integrators/centre_light.glsl"
#include "integrators/first_surface.glsl"
#include "integrators/phong.glsl"
#include "integrators/raster_sample.glsl"

layout(std430, binding = BINDING_VISIBILITY) readonly buffer Visibility { uvec4 visibility[]; };

vec3 shaded(SampleKey key, Surface s, MaterialPoint m, vec3 direction) {
    vec3 n = s.frame[2], wo = -direction * s.frame;
    PhongPoint p = phongAt(m, s.frontFace, max(wo.z, 0.0));
    vec3 sum = environmentIrradiance(n) * (p.diffuse + (1.0 - p.gloss) * p.reflected) * INV_PI;
    if (p.gloss > 0.0) sum += p.gloss * p.reflected * environmentRadiance(reflect(direction, n));
    if (has(FEATURE_TRANSMISSION) && maxComponent(p.through) > 0.0) sum += p.through * environmentRadiance(direction);
    for (uint i = 0u; i < centreLightCount(); i++) {
        LightSample l;
        bool extended;
        if (centreLight(i, key, s, l, extended) && dot(l.wi, s.geometricNormal) > 0.0)
            sum += phongEval(p, wo, l.wi * s.frame, 1.0) * l.radiance;
    }
    if ((m.flags & MATERIAL_EMISSIVE) != 0u && emitsTowards(m.flags, s.frontFace)) sum += m.emission;
    return sum;
}

bool seenSurface(uint slot, Ray ray, out Hit hit) {
    if (slot == NO_INDEX) return false;
    uint tag = LOAD(bvhTriangles, slot).w;
    if (kBvhShapes && (tag & kBvhShape) != 0u) return hitShapeAlone(slot, ray, hit);
    hit = Hit(0.0, tag & kBvhPrimitive, barycentricsOf(makeShearRay(ray), slot), slot);
    return true;
}

PathSample renderSample(uvec2 pixel, SampleKey key) {
    Ray ray = rasterRay(pixel, key.index);
    uvec4 block = drawnBlock();
    uvec2 at = pixel - block.xy;
    Hit hit;
    if (!seenSurface(visibility[at.y * block.z + at.x].x, ray, hit)) {
        PathSample result = nothingSeen();
        result.radiance = radianceFromOutside(ray.direction, true);
        return result;
    }
    Surface s = surfaceAt(hit, ray);
    MaterialPoint m = materialAt(s);
    bool unlit = has(FEATURE_UNLIT) && (m.flags & MATERIAL_UNLIT) != 0u;
    return seenAs(unlit ? m.baseColor : shaded(key, s, m, ray.direction), s, m, distance(s.position, ray.origin));
}

#define SHADES_A_DRAW
#include "sample_loop.glsl"
