// Rectangles, disks and boxes: shapes with flat faces, each scaled to side or radius 1 around the origin.
#ifndef SHAPES_FLAT_GLSL
#define SHAPES_FLAT_GLSL

const float SHAPE_FAR = 1e30;  // beyond every s that counts

// Where the ray is between −h and h along one axis. Nowhere: the first is larger.
vec2 slabCrossings(float f, float d, float h) {
    if (abs(d) < 1e-30) return abs(f) <= h ? vec2(-SHAPE_FAR, SHAPE_FAR) : vec2(SHAPE_FAR, -SHAPE_FAR);
    precise float low = (-h - f) / d, high = (h - f) / d;
    return vec2(min(low, high), max(low, high));
}

// Enters and leaves the box of these half sides.
bool boxCrossings(vec3 f, vec3 d, vec3 h, out vec2 s) {
    vec2 x = slabCrossings(f.x, d.x, h.x), y = slabCrossings(f.y, d.y, h.y), z = slabCrossings(f.z, d.z, h.z);
    s = vec2(max(x.x, max(y.x, z.x)), min(x.y, min(y.y, z.y)));
    return s.x <= s.y;
}

// The plane z = 0, within the square or the disk. Both crossings are the same one.
bool flatCrossing(vec3 f, vec3 d, bool disk, out vec2 s) {
    s = vec2(0);
    if (abs(d.z) < 1e-30) return false;
    precise float at = -f.z / d.z;
    precise vec2 p = f.xy + at * d.xy;
    s = vec2(at);
    return disk ? dot(p, p) <= 1.0 : max(abs(p.x), abs(p.y)) <= 1.0;
}

// Normal and tangent of a box's face, `axis` the normal's; every face reads its texture upright from outside.
void boxFace(uint axis, float side, out vec3 normal, out vec3 tangent) {
    normal = tangent = vec3(0);
    normal[axis] = side;
    if (axis == 0u) tangent.z = -side;
    else tangent.x = axis == 1u ? 1.0 : side;
}

#endif
