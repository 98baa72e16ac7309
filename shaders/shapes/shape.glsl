// Surfaces that are not triangles: spheres, boxes, … as gpu_types.h lists them (SHAPE_*).
//
// Each is crossed in its own space, which leaves the distance along the ray alone: centre and linear part are kept
// apart, so that no bit is lost to where the shape stands. A point on one is projected onto the exact surface before
// it goes back to world space, with a bound on all roundings of the way there and back: a ray that starts off the
// surface by that bound is on the side it should be, so it need not skip the shape and can cross it again.
//
// The including shader declares `uniform usamplerBuffer shapeTexels` and `const bool kBvhFields`, whether any is a field.
#ifndef SHAPES_SHAPE_GLSL
#define SHAPES_SHAPE_GLSL

#include "sphere.glsl"
#include "flat.glsl"
#include "round.glsl"
#include "field.glsl"

// A cut-out field may let a ray through this often.
const uint kMostCrossings = 64u;

// Relative error of n roundings (Higham 2002; PBRT 4th ed., 6.8.1).
float roundings(float n) { return n * 5.9604645e-8 / (1.0 - n * 5.9604645e-8); }

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
        f = preciseRows(x.xyz, y.xyz, z.xyz, f);
        d = preciseRows(x.xyz, y.xyz, z.xyz, d);
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
    switch (head.kind) {
        case SHAPE_SPHERE:
        case SHAPE_ELLIPSOID: c.any = sphereCrossings(ray.f, ray.d, sphereRadius(shape, head), c.s); break;
        case SHAPE_BOX: c.any = boxCrossings(ray.f, ray.d, vec3(1), c.s); break;
        case SHAPE_RECTANGLE:
        case SHAPE_DISK: c.any = flatCrossing(ray.f, ray.d, head.kind == SHAPE_DISK, c.s); break;
        case SHAPE_CYLINDER: c.any = cylinderCrossings(ray.f, ray.d, shapeSize(shape), c.s); break;
        case SHAPE_CAPSULE: c.any = capsuleCrossings(ray.f, ray.d, shapeSize(shape), c.s); break;
        // A field: the box that holds it. Without the last rounding there is nothing to be hit on the box itself.
        default: c.any = boxCrossings(ray.f, ray.d, shapeTexel(shape, 7u).xyz * 1.00001, c.s);
    }
    return c;
}

uint fieldInstructions(uint shape) { return LOAD(shapeTexels, shape * SHAPE_TEXELS + 7u).w; }

// The first crossing with a field beyond t = `after`, within the box.
bool nextFieldCrossing(uint shape, ShapeHead head, ShapeRay ray, vec2 box, float after, float tMax, out float s) {
    s = 0.0;
    vec3 size = shapeSize(shape);
    // Along the unit direction distances are lengths. A crossing that did not count is left behind by more than the
    // march can tell.
    float length_ = length(ray.d), beyond = after > 0.0 ? 4.0 * kFieldResolution * size.y : 0.0;
    float from = max(after / ray.scale * length_ + beyond, box.x * length_);
    float to = min(tMax / ray.scale, box.y) * length_;
    float at;
    if (!(from < to)) return false;
    if (!fieldCrossing(head.program, fieldInstructions(shape), ray.f, ray.d / length_, from, to, size.x, size.y, at)) return false;
    s = at / length_;
    return true;
}

// The first crossing beyond t = `after`, as s. `fields`: false, as a constant, where none of them can be.
bool nextCrossing(uint shape, ShapeHead head, ShapeRay ray, ShapeCrossings crossings, float after, float tMax, bool fields, out float s) {
    if (kBvhFields && fields && head.kind == SHAPE_FIELD && crossings.any)
        return nextFieldCrossing(shape, head, ray, crossings.s, after, tMax, s) && s * ray.scale > after;
    s = crossings.s.x * ray.scale > after ? crossings.s.x : crossings.s.y;
    return crossings.any && s * ray.scale > after;
}

// A point of the exact surface in the shape's own space.
struct OwnPoint {
    vec3 position, normal;  // the normal points outwards, or to the front
    vec3 tangent;           // along increasing u; normal × tangent along decreasing v
    vec2 uv;
    float error;  // of the position, beyond roundings of its coordinates
};

OwnPoint spherePoint(vec3 p) {
    OwnPoint o;
    o.position = o.normal = normalize(p);
    o.tangent = aroundY(p);
    o.uv = sphereUv(p);
    o.error = 0.0;
    return o;
}

OwnPoint facePoint(vec3 p, uint axis, float side) {
    OwnPoint o;
    boxFace(axis, side, o.normal, o.tangent);
    o.position = clamp(p, vec3(-1), vec3(1));
    o.position[axis] = side;
    o.uv = 0.5 + 0.5 * vec2(dot(o.position, o.tangent), -dot(o.position, cross(o.normal, o.tangent)));
    o.error = 0.0;
    return o;
}

OwnPoint boxPoint(vec3 p) {
    vec3 size = abs(p);
    uint axis = size.x >= max(size.y, size.z) ? 0u : size.y >= size.z ? 1u : 2u;
    return facePoint(p, axis, p[axis] < 0.0 ? -1.0 : 1.0);
}

OwnPoint flatPoint(vec3 p, bool disk) {
    OwnPoint o = facePoint(p, 2u, 1.0);
    o.position.z = 0.0;
    return o;
}

// On the side of a cone; v from `top` down over `height`.
OwnPoint sidePoint(vec3 p, ConeSide side, float top, float height) {
    float rho = length(p.xz);
    vec2 out_ = rho > 0.0 ? p.xz / rho : vec2(1, 0);
    float radius = max(side.mean + side.slope * p.y, 0.0);
    OwnPoint o;
    o.position = vec3(radius * out_.x, p.y, radius * out_.y);
    o.normal = normalize(vec3(out_.x, -side.slope, out_.y));
    o.tangent = aroundY(p);
    o.uv = vec2(sphereUv(p).x, (top - p.y) / height);
    // Near the tip the radius is a difference.
    o.error = roundings(8.0) * (abs(side.mean) + abs(side.slope * p.y));
    return o;
}

OwnPoint cylinderPoint(vec3 p, vec3 size) {
    ConeSide side = coneSide(size);
    float beyondSide = (length(p.xz) - (side.mean + side.slope * p.y)) * inversesqrt(1.0 + side.slope * side.slope);
    if (beyondSide >= abs(p.y) - size.x) return sidePoint(p, side, size.x, 2.0 * size.x);
    float up = p.y < 0.0 ? -1.0 : 1.0, radius = max(size.y, size.z);
    OwnPoint o = facePoint(p / vec3(radius, size.x, radius), 1u, up);
    o.position = vec3(p.x, up * size.x, p.z);
    return o;
}

OwnPoint capsulePoint(vec3 p, vec3 size) {
    CapsuleParts parts = capsuleParts(size);
    float top = size.x + size.z, height = 2.0 * size.x + size.y + size.z;
    OwnPoint o;
    if (p.y >= parts.top || p.y <= parts.bottom) {
        float radius = p.y >= parts.top ? size.z : size.y;
        vec3 centre = vec3(0, p.y >= parts.top ? size.x : -size.x, 0);
        o = spherePoint(p - centre);
        o.position = centre + radius * o.normal;
        o.uv.y = (top - o.position.y) / height;
        o.error = roundings(8.0) * (size.x + radius);
    } else {
        float middle = 0.5 * (parts.top + parts.bottom);
        o = sidePoint(p - vec3(0, middle, 0), coneSide(parts.frustum), top - middle, height);
        o.position.y += middle;
        o.error += roundings(8.0) * height;
    }
    return o;
}

OwnPoint fieldPoint(uint shape, ShapeHead head, vec3 p) {
    OwnPoint o;
    vec4 gradient = fieldGradient(head.program, fieldInstructions(shape), p);
    float steepness = length(gradient.xyz), size = shapeSize(shape).y;
    o.normal = steepness > 0.0 ? gradient.xyz / steepness : vec3(0, 1, 0);
    // A Newton step, against the roundings of a long way; not where the distance is none.
    o.position = p - clamp(gradient.w / max(steepness, 0.1), -1e-4 * size, 1e-4 * size) * o.normal;
    o.tangent = aroundY(p);
    o.uv = sphereUv(p);
    o.error = 4.0 * kFieldResolution * size;
    return o;
}

// `fields`: false, as a constant, where none of them can be.
OwnPoint ownPoint(uint shape, ShapeHead head, vec3 p, bool fields) {
    switch (head.kind) {
        case SHAPE_SPHERE:
        case SHAPE_ELLIPSOID: return spherePoint(p);
        case SHAPE_BOX: return boxPoint(p);
        case SHAPE_RECTANGLE:
        case SHAPE_DISK: return flatPoint(p, head.kind == SHAPE_DISK);
        case SHAPE_CYLINDER: return cylinderPoint(p, shapeSize(shape));
        case SHAPE_CAPSULE: return capsulePoint(p, shapeSize(shape));
    }
    if (kBvhFields && fields) return fieldPoint(shape, head, p);
    return spherePoint(p);
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

// Whether the ray is on its way out at a crossing, or comes from behind a flat one: it sees a back face.
bool leavesShape(uint shape, ShapeHead head, ShapeRay ray, float s, OwnPoint own) {
    return dot(head.kind <= SHAPE_ELLIPSOID ? rayPosition(shape, head, ray, s) : own.normal, ray.d) > 0.0;
}

struct ShapePoint {
    vec3 position;
    vec3 error;    // per coordinate: a ray that starts off by it, towards either side, starts on that side
    vec3 normal;   // unit, outwards or to the front
    vec4 tangent;  // unit, w: handedness as glTF has it
    vec2 uv;
    uint material;
};

// The point at s of the ray, which has hit the shape there, brought to the world.
ShapePoint shapePoint(uint shape, ShapeHead head, ShapeRay ray, float s, OwnPoint o) {
    vec4 x = shapeTexel(shape, 1u), y = shapeTexel(shape, 2u), z = shapeTexel(shape, 3u);
    vec4 toX = shapeTexel(shape, 4u), toY = shapeTexel(shape, 5u), toZ = shapeTexel(shape, 6u);
    vec3 centre = vec3(x.w, y.w, z.w);
    ShapePoint result;
    result.uv = o.uv;
    result.material = head.material;
    vec3 offset;
    if (head.kind == SHAPE_SPHERE) {
        // Without a matrix on the way: as round as floats can be.
        result.normal = normalize(rayPosition(shape, head, ray, s));
        offset = preciseScaled(result.normal, toX.w);
        result.error = roundings(10.0) * abs(offset);
    } else {
        offset = preciseRows(toX.xyz, toY.xyz, toZ.xyz, o.position);
        result.normal = normalize(o.normal.x * x.xyz + o.normal.y * y.xyz + o.normal.z * z.xyz);
        // There: the products and sums of the matrix. Back: the same of its inverse, which the matrix brings to the
        // world; and that the two are inverse but for their rounding.
        vec3 own = abs(o.position);
        vec3 there = vec3(dot(abs(toX.xyz), own), dot(abs(toY.xyz), own), dot(abs(toZ.xyz), own));
        vec3 back = vec3(dot(abs(x.xyz), there), dot(abs(y.xyz), there), dot(abs(z.xyz), there));
        vec3 forth = vec3(dot(abs(toX.xyz), back), dot(abs(toY.xyz), back), dot(abs(toZ.xyz), back));
        result.error = roundings(12.0) * there + roundings(8.0) * forth + o.error * vec3(dot(abs(toX.xyz), vec3(1)),
                                                                                        dot(abs(toY.xyz), vec3(1)), dot(abs(toZ.xyz), vec3(1)));
    }
    result.position = centre + offset;
    result.error += roundings(2.0) * abs(result.position);
    vec3 tangent = vec3(dot(toX.xyz, o.tangent), dot(toY.xyz, o.tangent), dot(toZ.xyz, o.tangent));
    tangent -= dot(tangent, result.normal) * result.normal;
    result.tangent = vec4(normalize(tangent), (head.flags & SHAPE_MIRRORED) != 0u ? -1.0 : 1.0);
    return result;
}

// The point at t of the ray, which has hit the shape there.
ShapePoint shapePointAt(uint shape, vec3 origin, vec3 direction, float t, bool fields) {
    ShapeHead head = loadShape(shape);
    ShapeRay ray = shapeRay(shape, head, origin, direction);
    float s = t / ray.scale;
    return shapePoint(shape, head, ray, s, ownPoint(shape, head, ownPosition(shape, head, ray, s), fields));
}

#endif
