// Where a ray crosses a sphere around the origin.
#ifndef SHAPES_SPHERE_GLSL
#define SHAPES_SPHERE_GLSL

// Both s at which f + s·d is on |p| = r, the nearer first; false for a miss. The discriminant comes from the
// perpendicular component of f, which keeps the bits that b² − 4ac loses far away (Haines et al., "Precision
// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019), and the second root from their product. A miss
// is right unless the ray passes within 8·2^-24·|f| of the sphere; an s is within 8·2^-24·max(|f|, r)/|d| ·
// (1 + r/√|r² − b²|) of the exact one, b the distance of the line from the centre.
bool sphereCrossings(vec3 f, vec3 d, float r, out vec2 s) {
    precise float dd = d.x * d.x + d.y * d.y + d.z * d.z;
    precise float middle = -(f.x * d.x + f.y * d.y + f.z * d.z) / dd;
    precise vec3 q = f + middle * d;
    precise float left = r * r - (q.x * q.x + q.y * q.y + q.z * q.z);
    s = vec2(0);
    if (!(left >= 0.0)) return false;
    precise float half_ = sqrt(left / dd);
    precise float larger = middle >= 0.0 ? middle + half_ : middle - half_;
    precise float product = (f.x * f.x + f.y * f.y + f.z * f.z - r * r) / dd;
    precise float smaller = larger != 0.0 ? product / larger : 0.0;
    s = vec2(min(larger, smaller), max(larger, smaller));
    return true;
}

// The point at s, one of the crossings. From the nearest point of the line to the centre, not from f: far from a small
// sphere f + s·d has no bits left, and may even be the centre.
vec3 spherePosition(vec3 f, vec3 d, float r, float s) {
    precise float dd = d.x * d.x + d.y * d.y + d.z * d.z;
    precise float middle = -(f.x * d.x + f.y * d.y + f.z * d.z) / dd;
    precise vec3 q = f + middle * d;
    float along = sqrt(max(0.0, r * r - (q.x * q.x + q.y * q.y + q.z * q.z)) / dd);
    return q + (s < middle ? -along : along) * d;
}

// Longitude and colatitude: u from −x through +z, as seen from outside to the right; v from +y down.
vec2 sphereUv(vec3 p) {
    float u = atan(p.z, -p.x) * 0.159154943;
    return vec2(u < 0.0 ? u + 1.0 : u, atan(length(p.xz), p.y) * 0.318309886);
}

// Along increasing u.
vec3 aroundY(vec3 p) {
    float rho = length(p.xz);
    return rho > 0.0 ? vec3(p.z, 0, -p.x) / rho : vec3(1, 0, 0);
}

#endif
