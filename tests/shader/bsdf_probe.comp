#version 460
// Runs the renderer's own BSDF code on a buffer of queries.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"
#include "../tests/shader/bsdf_probe.h"

#include "material_point.glsl"
#include "bsdf/bsdf.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Block { uint count; };
layout(std430, binding = BINDING_TILES) readonly buffer Queries { BsdfQuery queries[]; };
layout(std430, binding = BINDING_FILM) writeonly buffer Answers { BsdfAnswer answers[]; };

BsdfAnswer answer(BsdfQuery q) {
    MaterialPoint m = MaterialPoint(q.color.rgb, vec3(0), q.color.a, q.surface.x, q.surface.y, q.surface.z, vec3(0),
                                    q.surface.w != 0.0 ? MATERIAL_THIN : 0u, 0u);
    Bsdf bsdf = bsdfAt(m, q.wo.xyz, q.wo.w != 0.0);
    if (q.other.w != 0.0) {
        float pdf;
        vec3 f = bsdfEval(bsdf, q.wo.xyz, q.other.xyz, pdf);
        return BsdfAnswer(vec4(q.other.xyz, pdf), vec4(f, 1));
    }
    BsdfSample s;
    if (!bsdfSample(bsdf, q.wo.xyz, q.other.xyz, s)) return BsdfAnswer(vec4(0), vec4(0));
    return BsdfAnswer(vec4(s.wi, s.pdf), vec4(s.weight, s.delta ? 2.0 : 1.0));
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < count) answers[i] = answer(queries[i]);
}
