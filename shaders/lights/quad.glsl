// Rectangles that emit, sampled uniformly by the solid angle they fill (Ureña, Fajardo, King 2013, An
// Area-Preserving Parametrization for Spherical Rectangles). Where that angle is small the parametrization
// loses its digits in fp32, and uniform by area is as good: pdf and sample decide alike which one it is.
// LightRecord: corner p, edges a ⟂ b, `primitive` 1 if it emits to both sides, else 0: along a × b alone.
#ifndef QUAD_LIGHT_GLSL
#define QUAD_LIGHT_GLSL

#include "light_sample.glsl"

// sr. The angles of the parametrization are off by some 1e-6, so its points by 1e-4 of the rectangle at this.
const float QUAD_LEAST_SOLID_ANGLE = 0.01;

// A rectangle as seen from a point: x and y along its edges, the plane at the distance h.
struct SphericalRectangle {
    vec3 x, y, z;  // z from the point towards the plane
    float x0, x1, y0, y1, h;
    float solidAngle;  // sr; relative error 1e-5 unless the point is on an edge
    bool front;        // the point is on the side of a × b
};

// Of a triangle seen from the origin (Van Oosterom, Strackee 1983), with the triple product given: from edges and
// height it has no cancellation.
float triangleSolidAngle(float triple, vec3 a, vec3 b, vec3 c) {
    float la = length(a), lb = length(b), lc = length(c);
    float below = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
    return 2.0 * atan(triple, below);
}

SphericalRectangle sphericalRectangle(vec3 corner, vec3 a, vec3 b, vec3 from) {
    SphericalRectangle r;
    float width = length(a);
    r.x = a / width;
    // The corners of a sliver are rounded, and its edges then not at right angles: in axes that are not, directions would
    // come out beside it.
    vec3 across = b - dot(b, r.x) * r.x;
    float height = length(across);
    r.y = height > 0.0 ? across / height : vec3(0);
    vec3 normal = cross(r.x, r.y);
    vec3 d = corner - from;
    float h = dot(d, normal);
    r.front = h < 0.0;
    r.z = r.front ? -normal : normal;
    r.h = abs(h);
    r.x0 = dot(d, r.x);
    r.y0 = dot(d, r.y);
    r.x1 = r.x0 + width;
    r.y1 = r.y0 + height;
    vec3 v00 = vec3(r.x0, r.y0, r.h), v10 = vec3(r.x1, r.y0, r.h), v11 = vec3(r.x1, r.y1, r.h), v01 = vec3(r.x0, r.y1, r.h);
    float triple = width * height * r.h;
    r.solidAngle = triple > 0.0 && r.h * r.h > 0.0 ? triangleSolidAngle(triple, v00, v10, v11) + triangleSolidAngle(triple, v00, v11, v01) : 0.0;
    return r;
}

// Uniform by solid angle: coordinates in the plane.
vec2 sphericalRectangleSample(SphericalRectangle r, vec2 u) {
    // Unit normals of the planes through the edges y = y0, x = x1, y = y1, x = x0, as (share of h, of the other).
    float m0 = inversesqrt(r.y0 * r.y0 + r.h * r.h), m1 = inversesqrt(r.x1 * r.x1 + r.h * r.h);
    float m2 = inversesqrt(r.y1 * r.y1 + r.h * r.h), m3 = inversesqrt(r.x0 * r.x0 + r.h * r.h);
    float b0 = -r.y0 * m0, b1 = r.x1 * m1, b2 = r.y1 * m2, b3 = -r.x0 * m3;
    float a0 = r.h * m0, a2 = r.h * m2;
    // Interior angles of the spherical rectangle at the two corners of x0. The sine of each by the cross
    // product, a sum of squares without cancellation.
    float s2 = sqrt(a2 * a2 + b2 * b2 * (r.h * m3) * (r.h * m3)), s3 = sqrt(a0 * a0 + b0 * b0 * (r.h * m3) * (r.h * m3));
    float g2 = atan(s2, -b2 * b3), g3 = atan(s3, -b3 * b0);
    float au = u.x * r.solidAngle - (g2 + g3);
    float s = sin(au), n = cos(au) * b0 - b2;
    // x = h s / sqrt(n² − a0² s²) on the side of n / s.
    float below = max((n - a0 * s) * (n + a0 * s), 1e-30);
    float x = r.h * abs(s) * inversesqrt(below);
    x = clamp(n * s < 0.0 ? -x : x, r.x0, r.x1);
    float distance2 = x * x + r.h * r.h;
    float h0 = r.y0 * inversesqrt(distance2 + r.y0 * r.y0), h1 = r.y1 * inversesqrt(distance2 + r.y1 * r.y1);
    float hv = mix(h0, h1, u.y);
    float y = hv * sqrt(distance2 / max((1.0 - hv) * (1.0 + hv), 1e-12));
    return vec2(x, clamp(y, r.y0, r.y1));
}

// A point of the rectangle, in its plane's coordinates, for two uniform numbers.
vec2 quadSample(SphericalRectangle r, vec2 u) {
    if (r.solidAngle >= QUAD_LEAST_SOLID_ANGLE) return sphericalRectangleSample(r, u);
    return vec2(mix(r.x0, r.x1, u.x), mix(r.y0, r.y1, u.y));
}

// Solid-angle pdf, 1/sr, of finding a point at this distance; 0 from within the plane.
float quadPdf(SphericalRectangle r, float distance) {
    if (!(r.solidAngle > 0.0)) return 0.0;
    if (r.solidAngle >= QUAD_LEAST_SOLID_ANGLE) return 1.0 / r.solidAngle;
    return distance * distance * distance / (r.h * (r.x1 - r.x0) * (r.y1 - r.y0));
}

bool sampleQuadLight(LightRecord light, float pmf, uvec4 bits, Surface s, inout LightSample l) {
    SphericalRectangle r = sphericalRectangle(light.p, light.a, light.b, s.position);
    if (!(r.solidAngle > 0.0) || !(r.front || light.primitive != 0u)) return false;
    vec2 at = quadSample(r, unitFloat(bits.zw));
    vec3 inPlane = vec3(at, r.h);
    float distance = length(inPlane);
    inPlane /= distance;
    // Edges of a sliver far from the origin are at right angles only within the rounding of its corners.
    l.wi = normalize(inPlane.x * r.x + inPlane.y * r.y + inPlane.z * r.z);
    vec2 u = (at - vec2(r.x0, r.y0)) / vec2(r.x1 - r.x0, r.y1 - r.y0);
    vec3 position = light.p + u.x * light.a + u.y * light.b;
    vec3 error = gammaBound(7.0) * (abs(light.p) + abs(u.x * light.a) + abs(u.y * light.b));
    l.radiance = lightValue(light);
    l.pdf = pmf * quadPdf(r, distance);
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(position, error, r.z, -l.wi);
    l.infinite = false;
    return l.pdf > 0.0;
}

// Solid-angle pdf, 1/sr, with which a point of it at distance t from `from` is sampled.
float quadLightPdf(LightRecord light, vec3 from, float t) {
    return quadPdf(sphericalRectangle(light.p, light.a, light.b, from), t);
}

// All of it from its middle.
bool centreOfQuadLight(LightRecord light, Surface s, inout LightSample l) {
    SphericalRectangle r = sphericalRectangle(light.p, light.a, light.b, s.position);
    if (!(r.solidAngle > 0.0) || !(r.front || light.primitive != 0u)) return false;
    vec3 middle = light.p + 0.5 * light.a + 0.5 * light.b;
    vec3 error = gammaBound(7.0) * (abs(light.p) + abs(0.5 * light.a) + abs(0.5 * light.b));
    l.wi = normalize(middle - s.position);
    l.radiance = lightValue(light);
    l.pdf = 1.0 / r.solidAngle;
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    l.target = offsetOrigin(middle, error, r.z, -l.wi);
    l.infinite = false;
    return true;
}

#endif
