#version 460
#extension GL_GOOGLE_include_directive : require
// Traces a buffer of rays, for tests and benchmarks of the intersection code alone.
//     ray: 3 texels (origin, tMin | direction, tMax | skipPrimitive, key, startNormal, startReach)
//     hit: (bits of t, primitive, bits of the barycentrics); the primitive is kNoPrimitive for a miss. For anyHit
//          only the primitive is meant: 0 for a hit.

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint kBvhStackSize = 32u;
layout(constant_id = 1) const bool kBvhNonOpaque = false;
const bool kBvhCulls = false;
layout(constant_id = 2) const bool kAnyHit = false;
layout(constant_id = 3) const bool kBvhShapes = false;
layout(constant_id = 4) const bool kBvhCoincident = false;
const bool kBvhFields = false;
layout(set = 0, binding = 0) uniform usamplerBuffer bvhNodes;
layout(set = 0, binding = 1) uniform usamplerBuffer bvhTriangles;
layout(set = 0, binding = 2) uniform usamplerBuffer rays;
layout(set = 0, binding = 3) writeonly buffer Hits { uvec4 hits[]; };
layout(set = 0, binding = 4) uniform usamplerBuffer shapeTexels;
layout(push_constant) uniform Push { uint count; };

// A stand-in for an alpha test: checks of an eighth of the triangle, other ones for every key.
bool acceptHit(uint primitive, vec2 barycentrics, uint key) {
    uvec2 square = uvec2(barycentrics * 8.0);
    return ((square.x + square.y + primitive + key) & 1u) != 0u;
}

#include "intersect.glsl"

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint i = group * 64u + gl_LocalInvocationIndex;
    if (i >= count) return;
    vec4 origin = LOAD_FLOATS(rays, 3u * i), direction = LOAD_FLOATS(rays, 3u * i + 1u);
    uvec4 more = LOAD(rays, 3u * i + 2u);
    Ray ray = Ray(origin.xyz, origin.w, direction.xyz, direction.w, more.x, more.y, false, more.z, uintBitsToFloat(more.w));
    if (kAnyHit) {
        hits[i] = uvec4(0u, anyHit(ray) ? 0u : kNoPrimitive, 0u, 0u);
        return;
    }
    Hit hit;
    bool found = closestHit(ray, hit);
    hits[i] = found ? uvec4(floatBitsToUint(hit.t), hit.primitive, floatBitsToUint(hit.barycentrics))
                    : uvec4(0u, kNoPrimitive, 0u, 0u);
}
