// Cylinders, cones and capsules around the y axis.
#ifndef SHAPES_ROUND_GLSL
#define SHAPES_ROUND_GLSL

// The side of a cylinder or cone frustum: radius mean + slope · y.
struct ConeSide {
    float mean, slope;
};

ConeSide coneSide(vec3 size) { return ConeSide(0.5 * (size.y + size.z), (size.z - size.y) / (2.0 * size.x)); }

// Where the ray is within the endless cone, of its two halves the one that opens the way the frustum does. As with the
// sphere the discriminant comes from the nearest point of the line, here by the form x² + z² − radius².
vec2 coneCrossings(vec3 f, vec3 d, ConeSide side) {
    const vec2 all = vec2(-SHAPE_FAR, SHAPE_FAR), none = vec2(SHAPE_FAR, -SHAPE_FAR);
    precise float w = side.mean + side.slope * f.y, dw = side.slope * d.y;
    precise float round_ = d.x * d.x + d.z * d.z;
    precise float a = round_ - dw * dw, b = f.x * d.x + f.z * d.z - w * dw;
    precise float c = f.x * f.x + f.z * f.z - w * w;
    if (round_ + dw * dw < 1e-30) return c <= 0.0 ? all : none;
    if (a > 0.3 * round_) {
        precise float middle = -b / a;
        precise vec3 q = vec3(f.x + middle * d.x, f.z + middle * d.z, w + middle * dw);
        precise float left = q.z * q.z - (q.x * q.x + q.y * q.y);
        if (!(left >= 0.0)) return none;
        precise float half_ = sqrt(left / a);
        precise float larger = middle >= 0.0 ? middle + half_ : middle - half_;
        precise float smaller = larger != 0.0 ? c / a / larger : 0.0;
        return vec2(min(larger, smaller), max(larger, smaller));
    }
    // About along the side: one root may be at infinity, and so may be the nearest point.
    precise float discriminant = b * b - a * c;
    if (!(discriminant >= 0.0)) return a < 0.0 ? all : none;
    precise float k = b >= 0.0 ? -(b + sqrt(discriminant)) : sqrt(discriminant) - b;
    float first = k != 0.0 ? c / k : 0.0;
    if (abs(a) < 1e-20) return b > 0.0 ? vec2(-SHAPE_FAR, first) : vec2(first, SHAPE_FAR);
    float second = k / a;
    vec2 s = vec2(min(first, second), max(first, second));
    if (a > 0.0) return s;
    return dw > 0.0 ? vec2(s.y, SHAPE_FAR) : vec2(-SHAPE_FAR, s.x);
}

// Half height, radius at the bottom, at the top.
bool cylinderCrossings(vec3 f, vec3 d, vec3 size, out vec2 s) {
    // From far away the quadratic of a cone loses bits as the square of the way: go to where the ray is nearest first.
    precise float ahead = 0.0;
    precise vec3 start = f;
    if (dot(f, f) > 16.0 * dot(size, size)) {
        ahead = -preciseDot(f, d) / preciseDot(d, d);
        start = f + ahead * d;
    }
    vec2 slab = slabCrossings(start.y, d.y, size.x), side = coneCrossings(start, d, coneSide(size));
    s = vec2(max(slab.x, side.x), min(slab.y, side.y)) + ahead;
    return s.x <= s.y;
}

// What a capsule is the hull of: two spheres and the frustum that touches both.
struct CapsuleParts {
    float bottom, top;  // y of the circles where it touches
    vec3 frustum;       // its size
};

CapsuleParts capsuleParts(vec3 size) {
    float sine = (size.y - size.z) / (2.0 * size.x), cosine = sqrt(1.0 - sine * sine);
    CapsuleParts parts;
    parts.bottom = size.y * sine - size.x;
    parts.top = size.z * sine + size.x;
    parts.frustum = vec3(0.5 * (parts.top - parts.bottom), size.y * cosine, size.z * cosine);
    return parts;
}

void hullWith(bool any, vec2 other, inout bool found, inout vec2 s) {
    if (!any) return;
    s = found ? vec2(min(s.x, other.x), max(s.y, other.y)) : other;
    found = true;
}

// Half distance of the centres, radius below, radius above; neither sphere holds the other. The hull is convex and what
// it is made of lies within, so that it is entered where the first of them is and left where the last is.
bool capsuleCrossings(vec3 f, vec3 d, vec3 size, out vec2 s) {
    CapsuleParts parts = capsuleParts(size);
    bool found = false;
    s = vec2(0);
    vec2 part;
    bool any = sphereCrossings(f + vec3(0, size.x, 0), d, size.y, part);
    hullWith(any, part, found, s);
    any = sphereCrossings(f - vec3(0, size.x, 0), d, size.z, part);
    hullWith(any, part, found, s);
    any = cylinderCrossings(f - vec3(0, 0.5 * (parts.top + parts.bottom), 0), d, parts.frustum, part);
    hullWith(any, part, found, s);
    return found;
}

#endif
