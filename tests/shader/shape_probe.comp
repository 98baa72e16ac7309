#version 460
#extension GL_GOOGLE_include_directive : require
// Traces rays at surfaces that are not triangles and writes what the kernel makes of the hit, six texels each:
// (t, primitive, -, -) (position, u) (error, v) (normal, handedness) (tangent, -), then where a ray that goes on from
// there would hit next, forwards and back: (t forwards, t back, -, -), negative for none.

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint kBvhStackSize = 32u;
layout(constant_id = 1) const bool kBvhNonOpaque = false;
const bool kBvhCulls = false;
layout(constant_id = 2) const bool kBvhFields = false;
const bool kBvhShapes = true;
const bool kBvhCoincident = false;
layout(set = 0, binding = 0) uniform usamplerBuffer bvhNodes;
layout(set = 0, binding = 1) uniform usamplerBuffer bvhTriangles;
layout(set = 0, binding = 2) uniform usamplerBuffer rays;
layout(set = 0, binding = 3) writeonly buffer Hits { vec4 results[]; };
layout(set = 0, binding = 4) uniform usamplerBuffer shapeTexels;
layout(push_constant) uniform Push { uint count; };

// A stand-in for an alpha test: only where the number of the checker field of eight is even.
bool acceptHit(uint primitive, vec2 uv, uint key) {
    uvec2 square = uvec2(uv * 8.0);
    return ((square.x + square.y) & 1u) == 0u;
}

#include "intersect.glsl"

// As offsetOrigin of surface.glsl.
vec3 offset(vec3 position, vec3 error, vec3 normal, vec3 direction) {
    float distance = dot(abs(normal), error);
    return position + (dot(direction, normal) < 0.0 ? -distance : distance) * normal;
}

float goesOn(ShapePoint p, vec3 direction, uint primitive) {
    Hit next;
    Ray ray = freeRay(offset(p.position, p.error, p.normal, direction), direction, uintBitsToFloat(0x7f800000u), 0u);
    ray.skipPrimitive = primitive;
    return closestHit(ray, next) ? next.t : -1.0;
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint i = group * 64u + gl_LocalInvocationIndex;
    if (i >= count) return;
    vec4 origin = LOAD_FLOATS(rays, 3u * i), direction = LOAD_FLOATS(rays, 3u * i + 1u);
    uvec4 more = LOAD(rays, 3u * i + 2u);
    Ray ray = Ray(origin.xyz, origin.w, direction.xyz, direction.w, more.x, more.y, false, 0u, 0.0);
    Hit hit;
    if (!closestHit(ray, hit)) {
        for (uint k = 0u; k < 6u; ++k) results[6u * i + k] = vec4(-1);
        return;
    }
    ShapePoint p = shapePointAt(shapeOf(hit), ray.origin, ray.direction, hit.t, true);
    results[6u * i] = vec4(hit.t, float(hit.primitive), float(p.material), 0.0);
    results[6u * i + 1u] = vec4(p.position, p.uv.x);
    results[6u * i + 2u] = vec4(p.error, p.uv.y);
    results[6u * i + 3u] = vec4(p.normal, p.tangent.w);
    results[6u * i + 4u] = vec4(p.tangent.xyz, 0.0);
    results[6u * i + 5u] = vec4(goesOn(p, ray.direction, hit.primitive), goesOn(p, -ray.direction, hit.primitive), 0, 0);
}
