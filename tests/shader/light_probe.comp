#version 460
// Runs the renderer's own light sampling on a buffer of queries. Pdfs are those of the one light, without the
// probability of choosing it.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"
#include "../tests/shader/light_probe.h"

bool acceptHit(uint primitive, vec2 barycentrics, uint key);
#include "intersect.glsl"
#include "texture.glsl"
#include "surface.glsl"
#include "material.glsl"
#include "lights/light.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Block { uint count; };
layout(std430, binding = BINDING_TILES) readonly buffer Queries { LightQuery queries[]; };
layout(std430, binding = BINDING_FILM) writeonly buffer Answers { LightAnswer answers[]; };

Surface surfaceOf(LightQuery q) {
    Surface s;
    s.position = q.position.xyz;
    s.positionError = vec3(0);
    s.geometricNormal = q.normal.xyz;
    s.primitive = kNoPrimitive;
    return s;
}

LightAnswer nothing() { return LightAnswer(vec4(0), vec4(0), vec4(0)); }

LightAnswer sampled(LightQuery q) {
    LightSample l;
    SampleKey key = SampleKey(0u, q.ask.z, 7u);
    if (!sampleOnLight(loadLightRecord(q.ask.y), 1.0, q.bits, key, 0u, surfaceOf(q), l)) return nothing();
    float distance = l.infinite ? INFINITY : length(l.target - q.position.xyz);
    return LightAnswer(vec4(l.wi, l.pdf), vec4(l.radiance, 1), vec4(distance, 0, 0, 0));
}

LightAnswer pdfAlong(LightQuery q) {
    LightRecord asked = loadLightRecord(q.ask.y);
    vec3 d = q.direction.xyz;
    LightAnswer a = nothing();
    a.wi = vec4(d, 0);
    a.chosen.x = INFINITY;
    if (asked.type == LIGHT_ENVIRONMENT) {
        a.wi.w = environmentAlong(d).a;
    } else if (asked.type == LIGHT_SUN) {
        if (meetsSunLight(asked, d)) a.wi.w = sunLightPdf(asked);
    } else {
        Hit hit;
        Ray ray = freeRay(q.position.xyz, d, INFINITY, 0u);
        if (!closestHit(ray, hit)) return a;
        a.chosen.x = hit.t;
        Surface s = surfaceAt(hit, ray);
        uint light = LOAD(primitiveLightTexels, s.primitive >> 2u)[s.primitive & 3u];
        a.chosen.y = light == q.ask.y ? 1.0 : 0.0;
        if (light == q.ask.y && emitsTowards(materialFlags(s.material), s.frontFace)) {
            float pmf = lightPmf(light, asked.pmf, q.position.xyz, q.normal.xyz);
            float pdf = emitterPdf(s.primitive, q.position.xyz, q.normal.xyz, hit.t, abs(dot(s.geometricNormal, d)), false);
            a.wi.w = pmf > 0.0 ? pdf / pmf : -1.0;
        }
    }
    return a;
}

LightAnswer byTree(LightQuery q) {
    LightAnswer a = nothing();
    uint light;
    float pmf;
    if (!lightTreeSample(q.bits.xy, q.position.xyz, q.normal.xyz, light, pmf)) return a;
    a.radiance.w = 1.0;
    a.chosen = vec4(uintBitsToFloat(light), pmf, lightTreePmf(light, q.position.xyz, q.normal.xyz), 0);
    return a;
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    LightQuery q = queries[i];
    if (q.ask.x == PROBE_SAMPLE) {
        answers[i] = sampled(q);
    } else if (q.ask.x == PROBE_PDF) {
        answers[i] = pdfAlong(q);
    } else if (q.ask.x == PROBE_TREE) {
        answers[i] = byTree(q);
    } else {
        LightAnswer a = nothing();
        a.chosen.z = lightTreePmf(q.ask.y, q.position.xyz, q.normal.xyz);
        answers[i] = a;
    }
}
