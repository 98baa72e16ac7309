#version 460
// Whitted 1980: mirror and refraction rays branch at every surface, lights are points with hard shadows, shading is
// Phong's. No light from surface to surface but by mirrors; the environment lights matte surfaces unhidden. Free of
// noise, and wrong in ways that everybody knows.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#include "kernel.glsl"
#include "glass_shadow.glsl"
#include "integrators/ambient.glsl"
#include "integrators/centre_light.glsl"
#include "integrators/first_surface.glsl"
#include "integrators/phong.glsl"

// Rays that wait, at most, and rays of one sample. A ray that would carry less than the least weight is not followed.
const uint kMostWaiting = 24u;
const uint kMostRays = 1024u;
const float kLeastWeight = 1.0 / 4096.0;

struct Branch {
    Ray ray;
    vec3 weight;
    vec3 absorption;  // of the medium the ray is in
    uint depth;
};

Branch waiting[kMostWaiting];
uint waitingCount;
bool truncated;

void follow(Branch branch) {
    if (maxComponent(branch.weight) < kLeastWeight) return;
    if (branch.depth > parameters.maxBounces || waitingCount == kMostWaiting)
        truncated = true;
    else
        waiting[waitingCount++] = branch;
}

// What of a light comes to a surface: all, nothing, or what the panes between them let through.
vec3 inSight(LightSample l, Surface from, uint key) {
    if (!has(FEATURE_GLASS_SHADOWS)) return vec3(occluded(l, from, key) ? 0.0 : 1.0);
    Ray ray = shadowRay(l, from, key);
    vec3 left = vec3(1);
    Surface s;
    bool pane;
    for (uint panes = 0u; shadowMeets(l, ray, from, s, pane); panes++) {
        if (panes == MOST_PANES || !pane) return vec3(0);
        left *= phongAt(materialAt(s), s.frontFace, max(-dot(normalize(ray.direction), s.frame[2]), 0.0)).through;
        goBehind(s, l, ray);
        from = s;
    }
    return left;
}

// Light that lights and environment send from the surface towards wo, but for mirror images.
vec3 shaded(SampleKey key, uint depth, Surface s, PhongPoint p, vec3 wo) {
    vec3 sum = environmentIrradiance(s.frame[2]) * (p.diffuse + (1.0 - p.gloss) * p.reflected) * INV_PI;
    for (uint i = 0u; i < centreLightCount(); i++) {
        LightSample l;
        bool extended;
        if (!centreLight(i, key, s, l, extended) || dot(l.wi, s.geometricNormal) <= 0.0) continue;
        // What a mirror ray can meet has no need of a highlight.
        vec3 light = phongEval(p, wo, l.wi * s.frame, extended ? 1.0 - p.gloss : 1.0) * l.radiance;
        if (maxComponent(light) > 0.0) sum += light * inSight(l, s, shadowKey(key, depth));
    }
    return sum;
}

Branch startingAt(Surface s, vec3 direction, Branch from, vec3 weight) {
    Branch next = from;
    vec3 origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, direction);
    next.ray = freeRay(origin, direction, INFINITY, 0u);
    startOn(s, next.ray);
    next.ray.culls = cullsAll();
    // What coincides with a surface that a ray goes through is still before it.
    if (dot(direction, s.geometricNormal) < 0.0) next.ray.startReach = 0.0;
    next.weight = from.weight * weight;
    next.depth++;
    return next;
}

void reflectOff(Branch from, Surface s, PhongPoint p) {
    vec3 direction = reflect(from.ray.direction, s.frame[2]);
    if (dot(direction, s.geometricNormal) > 0.0) follow(startingAt(s, direction, from, p.reflected * p.gloss));
}

void branchOut(Branch from, Surface s, MaterialPoint m, PhongPoint p) {
    // What comes through a pane is most of it and is followed first, so that what many panes mirror back and forth finds
    // the rays used up and not the other way round.
    bool pane = has(FEATURE_GLASS_SHADOWS) && (m.flags & MATERIAL_PANE) != 0u;
    if (pane && waitingCount + 1u < kMostWaiting) reflectOff(from, s, p);
    if (has(FEATURE_TRANSMISSION) && maxComponent(p.through) > 0.0) {
        vec3 n = s.frame[2];
        vec3 direction = p.eta == 1.0 ? from.ray.direction : refract(from.ray.direction, n, 1.0 / p.eta);
        if (dot(direction, s.geometricNormal) < 0.0) {
            Branch beyond = startingAt(s, normalize(direction), from, p.through);
            // Panes behind the first surface that the camera sees are no bounces.
            if (pane) beyond.depth = max(from.depth, 1u);
            if (has(FEATURE_ATTENUATION) && (m.flags & MATERIAL_THIN) == 0u)
                beyond.absorption = s.frontFace ? m.absorption : vec3(0);
            follow(beyond);
        }
    }
    if (!pane) reflectOff(from, s, p);
}

// Light that arrives along a branch; the branches that it calls for wait.
vec3 lightAlong(SampleKey key, Branch branch, inout PathSample result) {
    Hit hit;
    branch.ray.key = cutoutKey(key, branch.depth);
    rayCount++;
    if (!closestHit(branch.ray, hit)) return branch.weight * radianceFromOutside(branch.ray.direction, branch.depth == 0u);
    if (has(FEATURE_ATTENUATION)) branch.weight *= exp(-branch.absorption * hit.t);
    Surface s = surfaceAt(hit, branch.ray);
    MaterialPoint m = materialAt(s);
    if (branch.depth == 0u) result = seenAs(vec3(0), s, m, hit.t);
    if (has(FEATURE_UNLIT) && (m.flags & MATERIAL_UNLIT) != 0u) return branch.weight * m.baseColor;
    vec3 light = vec3(0);
    if ((m.flags & MATERIAL_EMISSIVE) != 0u && emitsTowards(m.flags, s.frontFace)) light += m.emission;
    vec3 wo = -branch.ray.direction * s.frame;
    PhongPoint p = phongAt(m, s.frontFace, max(wo.z, 0.0));
    if (branch.depth < parameters.maxBounces) light += shaded(key, branch.depth, s, p, wo);
    branchOut(branch, s, m, p);
    return branch.weight * light;
}

PathSample traceSample(SampleKey key, vec3 origin, vec3 direction) {
    PathSample result = nothingSeen();
    vec3 radiance = vec3(0);
    truncated = false;
    waitingCount = 0u;
    follow(Branch(viewRay(key, origin, direction, 0u), vec3(1), vec3(0), 0u));
    for (uint rays = 0u; waitingCount > 0u && rays < kMostRays; rays++)
        radiance += lightAlong(key, waiting[--waitingCount], result);
    if (truncated || waitingCount > 0u) truncatedCount++;
    result.radiance = radiance;
    return result;
}

#include "sample_loop.glsl"
