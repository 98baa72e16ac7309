// Shadow rays that look at what they meet. KHR_materials_transmission without volume is infinitely thin: light goes
// straight on through it, so behind smooth glass of that kind lights are still in sight. Behind FEATURE_GLASS_SHADOWS.
#ifndef GLASS_SHADOW_GLSL
#define GLASS_SHADOW_GLSL

// The next surface in a shadow ray's way. False: the light is in sight.
bool shadowMeets(Ray ray, out Hit hit) {
    rayCount++;
    return closestHit(ray, hit);
}

Surface surfaceInShadow(Hit hit, Ray ray) {
    float size = length(ray.direction);
    ray.direction /= size;
    hit.t *= size;
    return surfaceAt(hit, ray);
}

// Has a shadow ray go on behind a surface that it met.
void goBehind(Surface s, LightSample l, inout Ray ray) {
    ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, ray.direction);
    if (!l.infinite) ray.direction = l.target - ray.origin;
    ray.skipPrimitive = s.primitive;
    ray.key += 0x9e3779b9u;  // what is cut out by chance and met again has a chance of its own
}

#endif
