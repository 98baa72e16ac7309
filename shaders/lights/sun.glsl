// Directional lights with an angular size: a disk of even radiance, infinitely far, sampled uniformly by
// solid angle. All in terms of h = 1 − cos θmax, which keeps its digits however small the disk is.
#ifndef SUN_GLSL
#define SUN_GLSL

// Solid-angle pdf, 1/sr.
float sunPdf(float h) { return 1.0 / (TWO_PI * h); }

// `towards` the middle of the disk.
vec3 sunSample(vec3 towards, float h, vec2 u) {
    float below = u.x * h;                         // 1 − cosθ
    float sinTheta = sqrt(below * (2.0 - below));
    float phi = TWO_PI * u.y;
    mat3 frame = frameAround(towards);
    return normalize(frame * vec3(sinTheta * cos(phi), sinTheta * sin(phi), 1.0 - below));
}

// Whether a direction meets the disk: by the chord, |d − t|² = 2 (1 − cosθ), since the cosine itself has lost it.
bool sunCovers(vec3 towards, float h, vec3 direction) {
    vec3 chord = direction - towards;
    return dot(chord, chord) <= 2.0 * h;
}

#endif
