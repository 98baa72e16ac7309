#version 460
// Runs parts of the path tracer by themselves, for cases that a picture would not show.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"
#include "../tests/numerics/probe.h"

layout(local_size_x = 64) in;
layout(push_constant) uniform Block { uint mode, count; };
layout(std430, binding = BINDING_TILES) readonly buffer Queries { vec4 queries[]; };
layout(std430, binding = BINDING_FILM) buffer Film { vec4 film[]; };
#define answers film
layout(std430, binding = BINDING_COUNTERS) buffer Counters { uint counters[]; };

bool acceptHit(uint primitive, vec2 barycentrics, uint key);
#include "intersect.glsl"
#include "texture.glsl"
#include "surface.glsl"
#include "material.glsl"
#include "lights/environment.glsl"
#include "film.glsl"
#include "path/medium.glsl"
#include "bsdf/facets.glsl"
#include "bsdf/fresnel.glsl"
#include "integrators/phong.glsl"

void unitFloats(uint i) {
    float u = unitFloat(i << 8u | 255u);
    if (!(u >= 0.0 && u < 1.0)) atomicAdd(counters[0], 1u);
    atomicMax(counters[1], floatBitsToUint(u));
}

void frames(uint i) {
    mat3 frame = frameAround(queries[i].xyz);
    for (int column = 0; column < 3; column++) answers[3u * i + column] = vec4(frame[column], 0);
}

void spawnedRays(uint i) {
    vec4 at = queries[2u * i];
    vec3 direction = queries[2u * i + 1u].xyz;
    Hit from = Hit(0.0, floatBitsToUint(at.y), at.zw, floatBitsToUint(at.x));
    Ray ray = freeRay(vec3(0), -direction, INFINITY, 0u);
    Surface s = surfaceAt(from, ray);
    ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, direction);
    ray.direction = direction;
    Hit hit;
    float self = closestHit(ray, hit) && hit.primitive == from.primitive ? 1.0 : 0.0;
    ray.skipPrimitive = from.primitive;
    float skipped = closestHit(ray, hit) && hit.primitive == from.primitive ? 1.0 : 0.0;
    answers[3u * i] = vec4(s.position, self);
    answers[3u * i + 1u] = vec4(s.positionError, skipped);
    answers[3u * i + 2u] = vec4(ray.origin, 0);
}

void passFilms(uint i) {
    FilmPixel pixel = emptyPixel();
    uint every = uint(queries[0].x);
    for (uint k = 0u; k < PROBE_PASS_SAMPLES; k++) {
        uint sample_ = i * PROBE_PASS_SAMPLES + k;
        float value = sample_ % every == 0u ? PROBE_SPIKE : 0.1;
        addSample(pixel, PathSample(vec3(value), vec3(0), vec3(0), 0.0, 0.0));
    }
    answers[2u * i] = pixel.mean;
    answers[2u * i + 1u] = pixel.m2;
}

void environmentSamples(uint i) {
    SampleKey key = SampleKey(17u, i, 4711u);
    vec3 radiance;
    float pdf;
    vec3 wi = environmentSample(randomBits(key, DIMENSION_ENVIRONMENT), radiance, pdf);
    answers[2u * i] = vec4(wi, pdf);
    answers[2u * i + 1u] = vec4(radiance, environmentAlong(wi).a);
}

void phasePdfs(uint i) {
    vec4 from = queries[2u * i];
    answers[i] = vec4(phasePdf(from.w, from.xyz, queries[2u * i + 1u].xyz));
}

void phaseSamples(uint i) {
    vec4 from = queries[0];
    uvec2 bits = pcg4d(uvec4(i, 29u, 0u, 1u)).xy;
    float pdf;
    vec3 wi = phaseSample(from.w, from.xyz, unitFloat(bits), pdf);
    answers[2u * i] = vec4(wi, pdf);
    answers[2u * i + 1u] = vec4(phasePdf(from.w, from.xyz, wi));
}

void masking(uint i) {
    vec3 w = queries[i].xyz;
    float alpha = queries[i].w;
    answers[3u * i] = vec4(ggxG1(w, alpha), 1.0 / (1.0 + beckmannLambda(w, vec2(alpha))), 1.0 / (1.0 + phongLambda(w, alpha)), 0);
    answers[3u * i + 1u] = vec4(ggxD(w, alpha), beckmannD(w, vec2(alpha)), phongD(w, alpha), 0);
    MaterialPoint m;
    materialPointDefaults(m);
    m.baseColor = vec3(1);
    m.metallic = m.transmission = 0.0;
    m.flags = 0u;
    m.alpha = alpha;
    m.ior = 1.5;
    answers[3u * i + 2u] = vec4(phongAt(m, true, w.z).exponent);
}

void main() {
    uint i = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (i >= count) return;
    switch (mode) {
        case PROBE_UNIT_FLOATS: unitFloats(i); break;
        case PROBE_FRAMES: frames(i); break;
        case PROBE_SPAWNED_RAYS: spawnedRays(i); break;
        case PROBE_PASS_FILMS: passFilms(i); break;
        case PROBE_ENVIRONMENT: environmentSamples(i); break;
        case PROBE_PHASE: phasePdfs(i); break;
        case PROBE_PHASE_SAMPLES: phaseSamples(i); break;
        case PROBE_MASKING: masking(i); break;
        case PROBE_EXPONENTIAL: answers[i] = vec4(exponential(floatBitsToUint(queries[i].xy))); break;
    }
}
