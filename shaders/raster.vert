#version 460
// Corners of the scene's triangles, from the buffer that ray traversal reads, projected as cameraRay projects; then
// boxes around the other surfaces.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"
layout(push_constant) uniform PassBlock { PassConstants pass; };
bool acceptHit(uint primitive, vec2 barycentrics, uint key) { return true; }
#include "intersect.glsl"
#include "camera.glsl"
#include "pixel_filter.glsl"
#include "integrators/raster_sample.glsl"

// How many vertices triangles have, then the slot of every shape.
layout(std430, binding = BINDING_SHAPE_SLOTS) readonly buffer ShapeSlots { uint shapeSlots[]; };

layout(location = 0) flat out uint slot;  // first texel in bvhTriangles

vec3 triangleCorner(uint texel, uint corner) {
    return vec3(LOAD_FLOATS(bvhTriangles, texel)[corner], LOAD_FLOATS(bvhTriangles, texel + 1u)[corner],
                LOAD_FLOATS(bvhTriangles, texel + 2u)[corner]);
}

// Half sides of a box around the origin of the shape's own space that holds it.
vec3 halfSides(uint shape, ShapeHead head) {
    vec3 size = shapeSize(shape);
    float radius = max(size.y, size.z);
    switch (head.kind) {
        case SHAPE_RECTANGLE:
        case SHAPE_DISK: return vec3(1, 1, 0);
        case SHAPE_CYLINDER: return vec3(radius, size.x, radius);
        case SHAPE_CAPSULE: return vec3(radius, size.x + radius, radius);
        case SHAPE_FIELD: return shapeTexel(shape, 7u).xyz;
    }
    return vec3(1);
}

// The i-th of the 36 corners of the 12 triangles around a shape.
vec3 boxCorner(uint shape, uint i) {
    const uint order[6] = uint[6](0u, 1u, 2u, 2u, 1u, 3u);
    uint face = i / 6u, axis = face >> 1u, at = order[i % 6u];
    vec3 corner;
    corner[axis] = (face & 1u) != 0u ? 1.0 : -1.0;
    corner[(axis + 1u) % 3u] = (at & 1u) != 0u ? 1.0 : -1.0;
    corner[(axis + 2u) % 3u] = (at & 2u) != 0u ? 1.0 : -1.0;
    ShapeHead head = loadShape(shape);
    vec4 x = shapeTexel(shape, 1u), y = shapeTexel(shape, 2u), z = shapeTexel(shape, 3u);
    vec4 toX = shapeTexel(shape, 4u), toY = shapeTexel(shape, 5u), toZ = shapeTexel(shape, 6u);
    vec3 own = corner * (1.0001 * halfSides(shape, head));  // no pixel of the shape may be lost to rounding
    vec3 offset = head.kind == SHAPE_SPHERE ? own * toX.w : vec3(dot(toX.xyz, own), dot(toY.xyz, own), dot(toZ.xyz, own));
    return vec3(x.w, y.w, z.w) + offset;
}

// cameraRay the other way round: film position times w, and w.
vec3 filmPosition(vec3 position, out float ahead) {
    SampleKey key = frameKey(pass.firstSample);
    CameraPose pose = cameraPose(key);
    bool flat_ = has(FEATURE_ORTHOGRAPHIC) && parameters.cameraKind == CAMERA_ORTHOGRAPHIC;
    vec3 shift = vec3(0);
    if (has(FEATURE_THIN_LENS) && parameters.lensRadius > 0.0 && !flat_) shift = lensShift(key, pose);
    vec3 d = position - (pose.origin + shift);
    ahead = dot(d, pose.forward);
    d += ahead * parameters.lensInverseFocus * shift;
    float w = flat_ ? 1.0 : ahead;
    vec2 ndc = vec2(dot(d, pose.right) / dot(pose.right, pose.right), dot(d, pose.up) / dot(pose.up, pose.up));
    return vec3(0.5 * (vec2(ndc.x, -ndc.y) + w) * vec2(parameters.imageSize), w);
}

void main() {
    uint vertex = uint(gl_VertexIndex), triangleVertices = kBvhShapes ? shapeSlots[0] : 0xffffffffu;
    vec3 position;
    if (vertex < triangleVertices) {
        uint corner = vertex % 3u;
        slot = vertex - corner;  // a triangle has as many texels as corners
        // Shapes have slots of their own among the triangles: all three corners at one point outside.
        if (kBvhShapes && (LOAD(bvhTriangles, slot).w & kBvhShape) != 0u) {
            gl_Position = vec4(2, 2, 0, 1);
            return;
        }
        position = triangleCorner(slot, corner);
    } else {
        slot = shapeSlots[1u + (vertex - triangleVertices) / 36u];
        position = boxCorner(LOAD(bvhTriangles, slot).x, (vertex - triangleVertices) % 36u);
    }
    float ahead;
    vec3 film = filmPosition(position, ahead);
    // A fragment lies at the middle of its pixel.
    uvec4 block = drawnBlock();
    vec2 raster = film.xy + film.z * (0.5 - rasterOffset(pass.firstSample) - vec2(block.xy));
    bool flat_ = has(FEATURE_ORTHOGRAPHIC) && parameters.cameraKind == CAMERA_ORTHOGRAPHIC;
    float depth = flat_ ? 1.0 - ahead / parameters.farPlane : parameters.nearPlane;
    gl_Position = vec4(2.0 * raster / vec2(block.zw) - film.z, depth, film.z);
}
