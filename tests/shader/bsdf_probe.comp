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

// In the order of ProbeMaterial.
MaterialPoint materialOf(vec4 p[PROBE_MATERIAL_TEXELS]) {
    MaterialPoint m;
    m.baseColor = p[0].rgb;
    m.metallic = p[0].a;
    m.emission = vec3(0);
    m.absorption = vec3(0);
    m.alpha = p[1].x;
    m.alphaT = p[1].y < 0.0 ? p[1].x : p[1].y;
    m.ior = p[1].z;
    m.transmission = p[1].w;
    m.flags = uint(p[2].x);
    m.albedoTable = p[2].y < 0.0 ? NO_INDEX : uint(p[2].y);
    m.specular = p[2].z;
    m.specularColor = p[3].rgb;
    m.dispersion = p[3].a;
    m.conductorEta = p[4].rgb;
    m.iridescence = p[4].a;
    m.conductorK = p[5].rgb;
    m.iridescenceIor = p[5].a;
    m.iridescenceThickness = p[6].x;
    m.clearcoat = p[6].y;
    m.clearcoatAlpha = p[6].z;
    m.sheenRoughness = p[6].w;
    m.clearcoatNormal = p[7].xyz;
    m.disneySheen = p[7].w;
    m.sheenColor = p[8].rgb;
    m.disneySheenTint = p[8].a;
    m.diffuseTransmissionColor = p[9].rgb;
    m.diffuseTransmission = p[9].a;
    m.subsurface = p[10].x;
    m.orenNayarSigma = p[10].y;
    m.coatTable = uint(max(p[10].z, 0.0));
    m.sheenTable = uint(max(p[10].w, 0.0));
    return m;
}

BsdfAnswer answer(BsdfQuery q) {
    Bsdf bsdf = bsdfAt(materialOf(q.material), q.wo.xyz, q.material[2].w != 0.0);
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
