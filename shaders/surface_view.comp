#version 460
// What the first surface is, shown as a picture: one of VIEW_*.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#include "kernel.glsl"
#include "integrators/first_surface.glsl"

// A colour that hardly any other number has.
vec3 colorOf(uint number) {
    uvec4 bits = pcg4d(uvec4(number, 0x6d61u, 0x7465u, 0x7269u));
    return 0.2 + 0.8 * vec3(unitFloat(bits.xy), unitFloat(bits.z));
}

vec3 shown(Surface s, MaterialPoint m, float t) {
    switch (uint(parameters.view)) {
        case VIEW_ALBEDO: return m.baseColor;
        case VIEW_NORMAL: return 0.5 + 0.5 * s.frame[2];
        case VIEW_GEOMETRIC_NORMAL: return 0.5 + 0.5 * s.geometricNormal;
        case VIEW_DEPTH: return vec3(t);
        case VIEW_UV: return vec3(s.uv0 - floor(s.uv0), 0.0);
        case VIEW_MATERIAL: return colorOf(s.material);
        case VIEW_OBJECT: return colorOf(LOAD(matteTexels, s.primitive >> 1u)[2u * (s.primitive & 1u)]);
    }
    return vec3(0);
}

PathSample traceSample(SampleKey key, vec3 origin, vec3 direction) {
    Hit hit;
    Surface s;
    if (!firstSurface(key, origin, direction, hit, s)) return nothingSeen();
    MaterialPoint m = materialAt(s);
    return seenAs(shown(s, m, hit.t), s, m, hit.t);
}

#include "sample_loop.glsl"
