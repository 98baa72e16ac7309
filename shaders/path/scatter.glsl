// How a path goes on at a surface, and whether it does.
#ifndef SCATTER_GLSL
#define SCATTER_GLSL

#include "direct_light.glsl"
#include "path_state.glsl"

// Ends paths whatever they carry, or none.
bool constantRoulette(inout PathState path, float u) {
    if (parameters.rouletteRule == ROULETTE_NONE) return true;
    if (u >= parameters.rouletteSurvival) return false;
    path.throughput /= parameters.rouletteSurvival;
    return true;
}

// Ends dim paths at random and makes up for it in those that survive, whose throughput is then 1: a survival less than
// the throughput would let the weights of long paths grow without bound. False: the path ends.
bool russianRoulette(inout PathState path, float u) {
    if (has(FEATURE_ROULETTE_RULE) && parameters.rouletteRule != ROULETTE_THROUGHPUT) return constantRoulette(path, u);
    float survival = maxComponent(path.throughput) * path.etaScale;
    if (u >= survival) return false;
    if (survival < 1.0) path.throughput /= survival;
    return true;
}

// Goes straight on through smooth thin-walled glass. Light behind it is still found by the last scattering, whose shadow
// rays cross it too, so all that weighs one against the other stays.
void crossPane(inout PathState path, Surface s, vec3 weight) {
    path.throughput *= weight;
    path.passed += distance(path.ray.origin, s.position);
    path.behindPane = path.behindPane || scatterings(path) == 0u;
    path.straight++;
    path.panes++;
    path.ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, path.ray.direction);
    startOn(s, path.ray);
}

// Scatters the path at a surface, or has it cross a pane. False: the path ends.
bool scatter(inout PathState path, Surface s, Bsdf bsdf, MaterialPoint m, vec3 wo, vec4 u) {
    BsdfSample b;
    bool found = sampleDirection(bsdf, wo, u.xyz, b);
    if (!found) {
        if (!b.blocked) rejectedCount++;
        return false;
    }
    vec3 direction = normalize(s.frame * b.wi);
    // A shading normal may send light into the surface, where none comes from.
    if (dot(direction, s.geometricNormal) * b.wi.z <= 0.0) return false;
    if (has(FEATURE_LIGHT_PATHS) && path.bounce == 0u) path.first = sharesAlong(bsdf, wo, b.wi, b.delta);
    path.crossed = has(FEATURE_GLASS_SHADOWS) && (m.flags & MATERIAL_PANE) != 0u && isStraightThrough(bsdf, b) &&
                   path.panes < MOST_PANES;
    if (path.crossed) {
        crossPane(path, s, b.weight);
        return maxComponent(path.throughput) > 0.0;
    }
    path.panes = 0u;
    path.passed = 0.0;
    path.throughput *= b.weight;
    path.pdf = b.pdf;
    path.delta = b.delta;
    if (has(FEATURE_REGULARISATION)) path.rough = path.rough || !b.delta;
    path.from = s.position;
    path.side = lightSide(s, bsdf);
    if ((has(FEATURE_TRANSMISSION) || has(FEATURE_DIFFUSE_TRANSMISSION)) && b.wi.z < 0.0 && !bsdf.face.thin) {
        if (transmits(bsdf.face)) path.etaScale *= bsdf.face.eta * bsdf.face.eta;
        if (mediaNest() && s.frontFace && isFull(path.medium.stack)) {
            rejectedCount++;
            return false;
        }
        path.medium = mediumBehind(path.medium, s, m, bsdf);
    }
    path.ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, direction);
    path.ray.direction = direction;
    startOn(s, path.ray);
    return maxComponent(path.throughput) > 0.0;
}

// Scatters the path at a point in fog. False: the path ends.
bool scatterInFog(inout PathState path, vec3 position, vec4 u) {
    if (has(FEATURE_LIGHT_PATHS) && path.bounce == 0u) path.first = scatteredInFog();
    path.ray.direction = phaseSample(fogAnisotropy(), path.ray.direction, u.xy, path.pdf);
    startOn(fogPoint(position), path.ray);
    path.ray.origin = position;
    path.crossed = false;
    path.panes = 0u;
    path.passed = 0.0;
    path.delta = false;
    if (has(FEATURE_REGULARISATION)) path.rough = true;
    path.from = position;
    path.side = vec3(0);
    return maxComponent(path.throughput) > 0.0;
}

// From its first dispersive surface on a path follows one channel, chosen uniformly and weighted up.
void disperse(inout PathState path, inout MaterialPoint m, SampleKey key) {
    if (path.channel == 3u) {
        path.channel = min(uint(3.0 * unitFloat(randomBits(key, DIMENSION_CHANNEL).x)), 2u);
        vec3 kept = vec3(0);
        kept[path.channel] = 3.0;
        path.throughput *= kept;
    }
    setChannel(m, path.channel);
}

#endif
