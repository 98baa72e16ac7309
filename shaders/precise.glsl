// Sums of products that every compiler rounds as they stand. `precise` keeps products and sums of its statement from
// being fused, but not those inside of dot() or a matrix (seen on an H200), so these are written out. What is not
// precise itself may be given to them: an argument is as it is. tests/lint finds what should have been one of these.
#ifndef PRECISE_GLSL
#define PRECISE_GLSL

float preciseDot(vec3 a, vec3 b) {
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

// The matrix of three rows times v.
vec3 preciseRows(vec3 row0, vec3 row1, vec3 row2, vec3 v) {
    return vec3(preciseDot(row0, v), preciseDot(row1, v), preciseDot(row2, v));
}

vec3 preciseScaled(vec3 v, float factor) {
    precise vec3 product = v * factor;
    return product;
}

#endif
