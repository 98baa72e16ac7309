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
layout(push_constant) uniform Block { uint count, batches; };
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

// Points of a lattice of three dimensions (Roberts 2018: powers of the root of x⁴ = x + 1) from a random start.
vec3 latticePoint(uint i, uvec4 start) {
    uvec3 bits = start.xyz + i * uvec3(3518319155u, 2882110345u, 2360945575u);
    return vec3(unitFloat(bits.x), unitFloat(bits.yz));
}

// The share of light that goes from wi to wo: radiance is compressed by 1/eta² where it refracts, but not in what passes
// the diffuse base.
vec3 energyOf(Bsdf bsdf, BsdfSample s, vec3 diffuse) {
    float compressed = s.wi.z < 0.0 && !bsdf.face.thin ? bsdf.face.eta * bsdf.face.eta : 1.0;
    return s.delta ? s.weight * compressed : diffuse / s.pdf + (s.weight - diffuse / s.pdf) * compressed;
}

bool isSound(BsdfSample s, vec3 energy) {
    bool pdf = s.delta || s.pdf > 0.0 && s.pdf < INFINITY;
    return pdf && isFinite(energy) && isFinite(s.wi) && all(greaterThanEqual(s.weight, vec3(0)));
}

// Mean energy of samples with dispersion's channels one after another, as path/scatter.glsl has them.
BsdfAnswer furnace(BsdfQuery q, MaterialPoint m, uint batch) {
    uint count = uint(q.other.x);
    uvec4 start = pcg4d(uvec4(uint(q.other.y), batch, 0x66757260u, 0u));
    uint channels = m.dispersion > 0.0 ? 3u : 1u;
    vec3 sum = vec3(0);
    float unsound = 0.0, found = 0.0;
    for (uint channel = 0u; channel < channels; channel++) {
        MaterialPoint seenBy = m;
        if (channels == 3u) setChannel(seenBy, channel);
        Bsdf bsdf = bsdfAt(seenBy, q.wo.xyz, q.material[2].w != 0.0);
        vec3 seen = vec3(0);
        for (uint i = 0u; i < count; i++) {
            BsdfSample s;
            if (!bsdfSample(bsdf, q.wo.xyz, latticePoint(i, start), s)) continue;
            float pdf;
            vec3 diffuse = vec3(0);
            if (!s.delta) bsdfEvalParts(bsdf, q.wo.xyz, s.wi, pdf, diffuse);
            vec3 energy = energyOf(bsdf, s, diffuse);
            if (isSound(s, energy)) {
                seen += energy;
            } else {
                unsound += 1.0;
            }
            found += 1.0;
        }
        if (channels == 1u) {
            sum = seen;
        } else {
            sum[channel] = seen[channel];
        }
    }
    return BsdfAnswer(vec4(sum / float(count), unsound), vec4(found / float(count * channels)));
}

BsdfAnswer answer(BsdfQuery q, uint batch) {
    MaterialPoint m = materialOf(q.material);
    if (q.other.w == PROBE_FURNACE) return furnace(q, m, batch);
    Bsdf bsdf = bsdfAt(m, q.wo.xyz, q.material[2].w != 0.0);
    if (q.other.w != PROBE_DRAW) {
        float pdf;
        vec3 diffuse;
        vec3 f = bsdfEvalParts(bsdf, q.wo.xyz, q.other.xyz, pdf, diffuse);
        return BsdfAnswer(vec4(q.other.w == PROBE_PARTS ? diffuse : q.other.xyz, pdf), vec4(f, 1));
    }
    BsdfSample s;
    if (!bsdfSample(bsdf, q.wo.xyz, q.other.xyz, s)) return BsdfAnswer(vec4(0), vec4(0));
    return BsdfAnswer(vec4(s.wi, s.pdf), vec4(s.weight, s.delta ? 2.0 : 1.0));
}

void main() {
    uint i = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (i < count * batches) answers[i] = answer(queries[i / batches], i % batches);
}
