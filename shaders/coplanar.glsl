// Faces that coincide with the one that a ray starts on: a floor that is there twice, a decal in a wall, a crate flush
// with its neighbour. By rounding a ray may meet them right where it starts; they are where it starts, so it does not.
//
// Offsetting the origin by its error bound is not enough: in a plane through the origin of the coordinates that bound
// is 0, and how well another triangle knows its t goes by the size of that triangle. So what is hit nearer than
// `startReach` is asked whether it lies in the plane of the start, which costs other hits one comparison. A face that
// only ends near the start, the wall beside a floor, has another normal and stops the ray however near it is.
#ifndef COPLANAR_GLSL
#define COPLANAR_GLSL

const float kCoplanarCosine = 0.999;  // 2.6°: normals of tiny decals are off by rounding, that of the start by its bytes

uint packStartNormal(vec3 normal) { return packSnorm4x8(vec4(normal, 0)); }

bool parallelToStart(Ray ray, vec3 normal) {
    vec3 start = unpackSnorm4x8(ray.startNormal).xyz;
    return abs(dot(start, normal)) > kCoplanarCosine * length(start) * length(normal);
}

// Whether the triangle at a texel lies in the plane of the start, within what rounding moves either: their coordinates,
// and how they are turned, where one is in y = 0 and the other has been turned into it.
bool isCoplanarTriangle(uint triangle, Ray ray) {
    vec3 x = LOAD_FLOATS(bvhTriangles, triangle).xyz;
    vec3 y = LOAD_FLOATS(bvhTriangles, triangle + 1u).xyz;
    vec3 z = LOAD_FLOATS(bvhTriangles, triangle + 2u).xyz;
    vec3 corner = vec3(x[0], y[0], z[0]);
    vec3 a = vec3(x[1], y[1], z[1]) - corner, b = vec3(x[2], y[2], z[2]) - corner;
    vec3 sizeA = abs(a), sizeB = abs(b);
    // Slivers and tiny triangles: scaling the edges keeps their products from underflow.
    a /= max(max(sizeA.x, max(sizeA.y, sizeA.z)), 1e-37);
    b /= max(max(sizeB.x, max(sizeB.y, sizeB.z)), 1e-37);
    precise vec3 normal = a.yzx * b.zxy - a.zxy * b.yzx;
    if (!parallelToStart(ray, normal)) return false;
    precise vec3 way = ray.origin - corner;
    precise float distance = normal.x * way.x + normal.y * way.y + normal.z * way.z;
    vec3 largest = vec3(max(abs(x.x), max(abs(x.y), abs(x.z))), max(abs(y.x), max(abs(y.y), abs(y.z))),
                        max(abs(z.x), max(abs(z.y), abs(z.z))));
    // Roundings of the normal's products and of this sum; then those of the corners, and how far the origin stands off.
    vec3 products = abs(a.yzx * b.zxy) + abs(a.zxy * b.yzx);
    float bound = roundings(4.0) * (length(products) * length(way)) +
                  roundings(16.0) * dot(abs(normal), max(largest, abs(ray.origin)));
    return abs(distance) <= bound;
}

// Likewise a shape's surface around a point of it.
bool isCoplanarShape(uint shape, Ray ray, ShapePoint p) {
    if (!parallelToStart(ray, p.normal)) return false;
    vec3 centre = vec3(shapeTexel(shape, 1u).w, shapeTexel(shape, 2u).w, shapeTexel(shape, 3u).w);
    float distance = dot(p.normal, p.position - ray.origin);
    float bound = roundings(4.0) * length(ray.origin - centre) +
                  dot(abs(p.normal), 2.0 * p.error + roundings(16.0) * abs(ray.origin));
    return abs(distance) <= bound;
}

#endif
