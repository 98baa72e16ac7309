// Surfaces where a signed distance is zero, met by sphere tracing.
//
// A field is a program in postfix order, three texels per instruction: (operation, parameters 0 … 2),
// (translation, parameter 3), (rotation as a quaternion). Primitives push the distance of the point, moved into their
// place; unions, intersections and differences take two distances and push one, smoothed over the length parameter 0
// (Quílez's quadratic smooth minimum, whose gradient is a mean of the two: nowhere steeper than 1).
#ifndef SHAPES_FIELD_GLSL
#define SHAPES_FIELD_GLSL

const uint kFieldSteps = 512u;
const uint kFieldScan = 64u;   // samples of what is left when the steps run out
const uint kFieldHalvings = 26u;
// Of the object's size: the least step, and how far off the surface rays leave it.
const float kFieldResolution = 1e-6;
// Likewise: less than this is inside. Roundings of the distance, so that no ray slips in where two primitives touch and
// the distance is zero all along the seam.
const float kFieldRounding = 2.5e-7;

struct FieldInstruction {
    uint operation;
    vec4 parameters;
    vec3 translation;
    vec4 rotation;
};

FieldInstruction loadInstruction(uint at) {
    uvec4 first = LOAD(shapeTexels, at);
    vec4 second = LOAD_FLOATS(shapeTexels, at + 1u);
    return FieldInstruction(first.x, vec4(uintBitsToFloat(first.yzw), second.w), second.xyz, LOAD_FLOATS(shapeTexels, at + 2u));
}

vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

float boxDistance(vec3 p, vec3 h) {
    vec3 q = abs(p) - h;
    return length(max(q, vec3(0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

// The vectors from the nearest points of cap and side, in (distance from the axis, y).
void coneVectors(vec2 q, vec3 size, out vec2 cap, out vec2 side, out float along) {
    vec2 top = vec2(size.z, size.x), slant = vec2(size.z - size.y, 2.0 * size.x);
    cap = vec2(q.x - min(q.x, q.y < 0.0 ? size.y : size.z), abs(q.y) - size.x);
    along = dot(top - q, slant) / dot(slant, slant);
    side = q - top + slant * clamp(along, 0.0, 1.0);
}

float coneDistance(vec3 p, vec3 size) {
    vec2 cap, side;
    float along;
    coneVectors(vec2(length(p.xz), p.y), size, cap, side, along);
    float inside = side.x < 0.0 && cap.y < 0.0 ? -1.0 : 1.0;
    return inside * sqrt(min(dot(cap, cap), dot(side, side)));
}

// The estimate by Hart, Sandin and Kauffman (1989) with the power in polar coordinates (White, Nylander). Not a true
// distance: the march takes shorter steps (size0 of the record) and looks out for having stepped over.
float mandelbulbDistance(vec3 p, float power, uint iterations) {
    vec3 z = p;
    float derivative = 1.0, r = length(z);
    for (uint i = 0u; i < iterations && r < 2.0; ++i) {
        if (r < 1e-6) return -1e-6;
        float theta = atan(length(z.xy), z.z) * power, phi = atan(z.y, z.x) * power;
        derivative = pow(r, power - 1.0) * power * derivative + 1.0;  // lint pow: r >= 1e-6
        float s = sin(theta);
        // lint pow: r >= 1e-6
        z = pow(r, power) * vec3(s * cos(phi), s * sin(phi), cos(theta)) + p;
        r = length(z);
    }
    return r < 2.0 ? -1e-6 : 0.5 * log(r) * r / derivative;  // what has not escaped is inside
}

float primitiveDistance(FieldInstruction i, vec3 p) {
    vec4 rotation = i.rotation * vec4(-1, -1, -1, 1);
    p = turned(rotation, p - i.translation);
    if (i.operation == FIELD_SPHERE) return length(p) - i.parameters.x;
    if (i.operation == FIELD_BOX) return boxDistance(p, i.parameters.xyz - i.parameters.w) - i.parameters.w;
    if (i.operation == FIELD_TORUS) return length(vec2(length(p.xz) - i.parameters.x, p.y)) - i.parameters.y;
    if (i.operation == FIELD_CONE) return coneDistance(p, i.parameters.xyz);
    return mandelbulbDistance(p, i.parameters.x, uint(i.parameters.y));
}

float smoothMinimum(float a, float b, float k) {
    float h = k > 0.0 ? max(k - abs(a - b), 0.0) / k : 0.0;
    return min(a, b) - 0.25 * h * h * k;
}

float combined(uint operation, float a, float b, float k) {
    if (operation == FIELD_UNION) return smoothMinimum(a, b, k);
    return -smoothMinimum(-a, operation == FIELD_DIFFERENCE ? b : -b, k);
}

// Signed distance at a point, below the true one outside.
float fieldDistance(uint program, uint instructions, vec3 p) {
    float stack[FIELD_STACK];
    uint top = 0u;
    for (uint n = 0u; n < instructions; ++n) {
        FieldInstruction i = loadInstruction(program + n * FIELD_TEXELS);
        if (i.operation >= FIELD_UNION) {
            --top;
            stack[top - 1u] = combined(i.operation, stack[top - 1u], stack[top], i.parameters.x);
        } else {
            stack[top++] = primitiveDistance(i, p);
        }
    }
    return stack[0];
}

vec3 boxGradient(vec3 p, vec3 h) {
    vec3 q = abs(p) - h;
    vec3 outside = max(q, vec3(0)), side = mix(vec3(-1), vec3(1), greaterThanEqual(p, vec3(0)));
    float length_ = length(outside);
    if (length_ > 0.0) return side * outside / length_;
    return q.x >= max(q.y, q.z) ? vec3(side.x, 0, 0) : q.y >= q.z ? vec3(0, side.y, 0) : vec3(0, 0, side.z);
}

vec2 unitOr(vec2 v, vec2 other) {
    float squared = dot(v, v);
    return squared > 0.0 ? v * inversesqrt(squared) : other;
}

vec3 around(vec3 p, vec2 gradient) {
    float rho = length(p.xz);
    vec2 out_ = rho > 0.0 ? p.xz / rho : vec2(1, 0);
    return vec3(out_.x * gradient.x, gradient.y, out_.y * gradient.x);
}

vec3 coneGradient(vec3 p, vec3 size) {
    vec2 cap, side;
    float along;
    coneVectors(vec2(length(p.xz), p.y), size, cap, side, along);
    float upper = p.y < 0.0 ? -1.0 : 1.0;
    vec2 slanted = normalize(vec2(2.0 * size.x, size.y - size.z)), flat_ = vec2(0, upper);
    // On faces the direction is theirs; the vectors vanish there. Past an edge they point away from it.
    if (dot(cap, cap) < dot(side, side)) return around(p, cap.x > 0.0 ? unitOr(vec2(cap.x, upper * cap.y), flat_) : flat_);
    return around(p, along > 0.0 && along < 1.0 ? slanted : unitOr(side, slanted));
}

// Differences towards the corners of a tetrahedron. (One call in a loop: kernels grow with every copy of the distance.)
vec3 mandelbulbGradient(FieldInstruction i, vec3 p) {
    const float h = 2e-4;
    uint iterations = uint(i.parameters.y);
    vec3 sum = vec3(0);
    for (uint corner = 0u; corner < 4u; ++corner) {
        vec3 k = corner == 0u ? vec3(1, -1, -1) : corner == 1u ? vec3(-1, -1, 1) : corner == 2u ? vec3(-1, 1, -1) : vec3(1);
        sum += k * mandelbulbDistance(p + h * k, i.parameters.x, iterations);
    }
    float length_ = length(sum);
    return length_ > 0.0 ? sum / length_ : normalize(p + vec3(0, 1e-6, 0));
}

vec3 primitiveGradient(FieldInstruction i, vec3 p) {
    vec4 rotation = i.rotation * vec4(-1, -1, -1, 1);
    p = turned(rotation, p - i.translation);
    vec3 g;
    if (i.operation == FIELD_SPHERE) g = dot(p, p) > 0.0 ? normalize(p) : vec3(0, 1, 0);
    else if (i.operation == FIELD_BOX) g = boxGradient(p, i.parameters.xyz - i.parameters.w);
    else if (i.operation == FIELD_TORUS) g = around(p, unitOr(vec2(length(p.xz) - i.parameters.x, p.y), vec2(1, 0)));
    else if (i.operation == FIELD_CONE) g = coneGradient(p, i.parameters.xyz);
    else g = mandelbulbGradient(i, p);
    return turned(i.rotation, g);
}

// Distance and its gradient, of unit length but where smoothing mixes two.
vec4 fieldGradient(uint program, uint instructions, vec3 p) {
    vec4 stack[FIELD_STACK];  // gradient, distance
    uint top = 0u;
    for (uint n = 0u; n < instructions; ++n) {
        FieldInstruction i = loadInstruction(program + n * FIELD_TEXELS);
        if (i.operation < FIELD_UNION) {
            stack[top++] = vec4(primitiveGradient(i, p), primitiveDistance(i, p));
            continue;
        }
        --top;
        vec4 a = stack[top - 1u], b = stack[top];
        if (i.operation == FIELD_DIFFERENCE) b = -b;
        float sign_ = i.operation == FIELD_UNION ? 1.0 : -1.0, k = i.parameters.x;
        float apart = sign_ * (a.w - b.w), h = k > 0.0 ? max(k - abs(apart), 0.0) / k : 0.0;
        vec3 gradient = mix(a.xyz, b.xyz, apart < 0.0 ? 0.5 * h : 1.0 - 0.5 * h);
        stack[top - 1u] = vec4(gradient, sign_ * smoothMinimum(sign_ * a.w, sign_ * b.w, k));
    }
    return stack[0];
}

// The first change of side along the unit direction u between `from` and `to`. Steps are as long as the distance allows
// but never below the resolution, so that a ray neither stops short of the surface nor stays on the one it starts on;
// having crossed shows by the sign, also where a step was too long for the field. When the steps run out (a ray that hugs
// the surface) what is left is looked at by even steps. A change found is narrowed by halving. All in one loop with one
// call of the distance: it is what kernels with fields consist of, and compiling takes as long as they are large.
bool fieldCrossing(uint program, uint instructions, vec3 f, vec3 u, float from, float to, float stepScale, float size, out float at) {
    const uint kMarch = kFieldSteps + 1u, kScan = kMarch + kFieldScan;  // looks up to the end of each phase
    float least = kFieldResolution * size, skin = kFieldRounding * size, level = skin;
    float distance = 0.0, next = from, high = from, scanStep = 0.0;
    bool inside = false, narrows = false;
    uint halvings = 0u;
    at = from;
    for (uint look = 0u; look < kScan || narrows; ++look) {
        float before = distance;
        distance = fieldDistance(program, instructions, f + next * u);
        if (narrows) {
            if (distance < level == inside) at = next;
            else high = next;
        } else if (look == 0u) {
            inside = distance < skin;
        } else if (distance < skin != inside) {
            // To the surface itself, unless only its skin has been crossed.
            if (look < kMarch) level = min(before, distance) < 0.0 ? 0.0 : skin;
            high = next;
            narrows = true;
        } else {
            at = next;
        }
        if (narrows) {
            if (halvings++ == kFieldHalvings || !(high - at > 1e-7 * high)) {
                at = high;
                return true;
            }
            next = 0.5 * (at + high);
            continue;
        }
        if (look + 1u < kMarch) {
            if (!(at < to)) return false;
            next = min(at + max(abs(distance) * stepScale, max(least, 1e-7 * at)), to);
        } else {
            if (look + 1u == kMarch) {
                if (at >= to) return false;
                scanStep = (to - at) / float(kFieldScan);
            }
            next = at + scanStep;
        }
    }
    return false;
}

#endif
