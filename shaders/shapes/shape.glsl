// Surfaces that are not triangles: spheres, boxes, … as gpu_types.h lists them (SHAPE_*).
//
// Each is crossed in its own space, which leaves the distance along the ray alone: centre and linear part are kept
// apart, so that no bit is lost to where the shape stands. A point on one is projected onto the exact surface before
// it goes back to world space, with a bound on all roundings of the way there and back: a ray that starts off the
// surface by that bound is on the side it should be, so it need not skip the shape and can cross it again.
//
// The including shader declares `uniform usamplerBuffer shapeTexels`.
#ifndef SHAPES_SHAPE_GLSL
#define SHAPES_SHAPE_GLSL

#include "sphere.glsl"

// A cut-out field may let a ray through this often.
const uint kMostCrossings = 64u;

struct ShapeHead {
    uint kind, material, flags, program;
};

ShapeHead loadShape(uint shape) {
    uvec4 t = LOAD(shapeTexels, shape * SHAPE_TEXELS);
    return ShapeHead(t.x, t.y, t.z, t.w);
}

vec4 shapeTexel(uint shape, uint texel) { return LOAD_FLOATS(shapeTexels, shape * SHAPE_TEXELS + texel); }

vec3 shapeSize(uint shape) { return vec3(shapeTexel(shape, 4u).w, shapeTexel(shape, 5u).w, shapeTexel(shape, 6u).w); }

// A ray that starts on one cannot meet it again.
bool isFlat(uint kind) { return kind == SHAPE_RECTANGLE || kind == SHAPE_DISK; }

// A ray in the space in which the shape is crossed: f + s·d, t = s·scale. A sphere's is the world's around its
// centre. The power of two that scales d rounds nothing and keeps its squares from overflow.
struct ShapeRay {
    vec3 f, d;
    float scale;
};

ShapeRay shapeRay(uint shape, ShapeHead head, vec3 origin, vec3 direction) {
    vec4 x = shapeTexel(shape, 1u), y = shapeTexel(shape, 2u), z = shapeTexel(shape, 3u);
    precise vec3 f = origin - vec3(x.w, y.w, z.w);
    precise vec3 d = direction;
    if (head.kind != SHAPE_SPHERE) {
        f = vec3(dot(x.xyz, f), dot(y.xyz, f), dot(z.xyz, f));
        d = vec3(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d));
    }
    vec3 size = abs(d);
    uint exponent = clamp(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23u, 1u, 253u);
    ShapeRay own;
    own.scale = uintBitsToFloat((254u - exponent) << 23u);
    own.f = f;
    own.d = d * own.scale;
    return own;
}

float sphereRadius(uint shape, ShapeHead head) { return head.kind == SHAPE_SPHERE ? shapeTexel(shape, 4u).w : 1.0; }

// The crossings of a convex shape, all there are.
struct ShapeCrossings {
    bool any;
    vec2 s;
};

ShapeCrossings shapeCrossings(uint shape, ShapeHead head, ShapeRay ray, float tMin, float tMax) {
    ShapeCrossings c = ShapeCrossings(false, vec2(0));
    if (head.kind <= SHAPE_ELLIPSOID) c.any = sphereCrossings(ray.f, ray.d, sphereRadius(shape, head), c.s);
    return c;
}

// The first crossing beyond t = `after`, as s.
bool nextCrossing(uint shape, ShapeHead head, ShapeRay ray, ShapeCrossings crossings, float after, float tMax, out float s) {
    s = crossings.s.x * ray.scale > after ? crossings.s.x : crossings.s.y;
    return crossings.any && s * ray.scale > after;
}

// A point of the exact surface in the shape's own space.
struct OwnPoint {
    vec3 position, normal;  // the normal points outwards, or to the front
    vec3 tangent;           // along increasing u; normal × tangent along decreasing v
    vec2 uv;
};

OwnPoint ownPoint(uint shape, ShapeHead head, vec3 p) {
    OwnPoint o;
    o.position = o.normal = p / length(p);
    o.tangent = aroundY(o.normal);
    o.uv = sphereUv(o.normal);
    return o;
}

// Where the ray is at s, one of its crossings.
vec3 rayPosition(uint shape, ShapeHead head, ShapeRay ray, float s) {
    if (head.kind <= SHAPE_ELLIPSOID) return spherePosition(ray.f, ray.d, sphereRadius(shape, head), s);
    precise vec3 p = ray.f + s * ray.d;
    return p;
}

// Likewise, a sphere's turned into its own space.
vec3 ownPosition(uint shape, ShapeHead head, ShapeRay ray, float s) {
    vec3 p = rayPosition(shape, head, ray, s);
    if (head.kind == SHAPE_SPHERE)
        p = vec3(dot(shapeTexel(shape, 1u).xyz, p), dot(shapeTexel(shape, 2u).xyz, p), dot(shapeTexel(shape, 3u).xyz, p));
    return p;
}

vec2 shapeUv(uint shape, ShapeHead head, ShapeRay ray, float s) {
    return ownPoint(shape, head, ownPosition(shape, head, ray, s)).uv;
}

struct ShapePoint {
    vec3 position;
    vec3 error;    // per coordinate: a ray that starts off by it, towards either side, starts on that side
    vec3 normal;   // unit, outwards or to the front
    vec4 tangent;  // unit, w: handedness as glTF has it
    vec2 uv;
    uint material;
};

// Relative error of n roundings (Higham 2002; PBRT 4th ed., 6.8.1).
float roundings(float n) { return n * 5.9604645e-8 / (1.0 - n * 5.9604645e-8); }

// The point at t of the ray, which has hit the shape there.
ShapePoint shapePointAt(uint shape, vec3 origin, vec3 direction, float t) {
    ShapeHead head = loadShape(shape);
    ShapeRay ray = shapeRay(shape, head, origin, direction);
    float s = t / ray.scale;
    OwnPoint o = ownPoint(shape, head, ownPosition(shape, head, ray, s));
    vec4 x = shapeTexel(shape, 1u), y = shapeTexel(shape, 2u), z = shapeTexel(shape, 3u);
    vec4 toX = shapeTexel(shape, 4u), toY = shapeTexel(shape, 5u), toZ = shapeTexel(shape, 6u);
    vec3 centre = vec3(x.w, y.w, z.w);
    ShapePoint result;
    result.uv = o.uv;
    result.material = head.material;
    precise vec3 offset;
    if (head.kind == SHAPE_SPHERE) {
        // Without a matrix on the way: as round as floats can be.
        result.normal = normalize(rayPosition(shape, head, ray, s));
        offset = result.normal * toX.w;
        result.error = roundings(10.0) * abs(offset);
    } else {
        offset = vec3(dot(toX.xyz, o.position), dot(toY.xyz, o.position), dot(toZ.xyz, o.position));
        result.normal = normalize(o.normal.x * x.xyz + o.normal.y * y.xyz + o.normal.z * z.xyz);
        // There: the products and sums of the matrix. Back: the same of its inverse, which the matrix brings to the
        // world; and that the two are inverse but for their rounding.
        vec3 own = abs(o.position);
        vec3 there = vec3(dot(abs(toX.xyz), own), dot(abs(toY.xyz), own), dot(abs(toZ.xyz), own));
        vec3 back = vec3(dot(abs(x.xyz), there), dot(abs(y.xyz), there), dot(abs(z.xyz), there));
        vec3 forth = vec3(dot(abs(toX.xyz), back), dot(abs(toY.xyz), back), dot(abs(toZ.xyz), back));
        result.error = roundings(12.0) * there + roundings(8.0) * forth;
    }
    result.position = centre + offset;
    result.error += roundings(2.0) * abs(result.position);
    vec3 tangent = vec3(dot(toX.xyz, o.tangent), dot(toY.xyz, o.tangent), dot(toZ.xyz, o.tangent));
    tangent -= dot(tangent, result.normal) * result.normal;
    result.tangent = vec4(normalize(tangent), (head.flags & SHAPE_MIRRORED) != 0u ? -1.0 : 1.0);
    return result;
}

#endif
