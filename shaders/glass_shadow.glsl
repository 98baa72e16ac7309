// Shadow rays that look at what they meet. KHR_materials_transmission without volume is infinitely thin: light goes
// straight on through it, so behind smooth glass of that kind lights are still in sight. Behind FEATURE_GLASS_SHADOWS.
#ifndef GLASS_SHADOW_GLSL
#define GLASS_SHADOW_GLSL

// The next thing in the way of a light's shadow ray that starts on `from`. False: the light is in sight. `pane`: it may be
// one, whose surface is `s`; of all else there is nothing to know.
bool shadowMeets(LightSample l, Ray ray, Surface from, out Surface s, out bool pane) {
    pane = false;
    Hit hit;
    bool amongFaces = nextAmongFaces(from, ray.direction, ray.key, hit);
    if (!amongFaces) {
        rayCount++;
        if (!closestHit(ray, hit)) return false;
    }
    uint flags = materialFlags(loadPrimitive(hit.primitive).material);
    if ((flags & (MATERIAL_PANE | MATERIAL_COINCIDENT)) == 0u) {
        noteShadow(l, hit.primitive);
        return true;
    }
    float size = length(ray.direction);
    ray.direction /= size;
    hit.t *= size;
    s = surfaceAt(hit, ray);
    s.coincides = amongFaces;
    if (!amongFaces) arriveAmongFaces(s, ray, hit);
    pane = (materialFlags(s.material) & MATERIAL_PANE) != 0u;
    if (!pane) noteShadow(l, s.primitive);
    return true;
}

// Has a shadow ray go on behind a surface that it met.
void goBehind(Surface s, LightSample l, inout Ray ray) {
    ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, ray.direction);
    if (!l.infinite) ray.direction = l.target - ray.origin;
    startOn(s, ray);
    ray.key += 0x9e3779b9u;  // what is cut out by chance and met again has a chance of its own
}

#endif
