#version 460
// The path tracer: one invocation per pixel, several samples per dispatch. Paths start at the camera;
// at each surface and wherever fog scatters them lights are sampled (next event estimation) and the BSDF or the phase
// function is sampled, both weighted by the power heuristic unless the settings leave one of them out. Without bias but
// for the bounce limit that the job sets.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#include "kernel.glsl"
#include "path/direct_light.glsl"
#include "path/found_light.glsl"
#include "path/meet.glsl"
#include "path/path_state.glsl"
#include "path/scatter.glsl"

PathState startPath(SampleKey key, vec3 origin, vec3 direction) {
    PathState path;
    path.ray = viewRay(key, origin, direction, 0u);
    path.throughput = vec3(1);
    path.radiance = vec3(0);
    path.medium = outside();
    if (mediaNest()) path.medium = innermost(parameters.cameraMedia);
    path.pdf = 0.0;
    path.etaScale = 1.0;
    path.delta = true;
    path.from = path.side = vec3(0);
    path.channel = 3u;
    path.bounce = path.straight = path.panes = 0u;
    path.passed = 0.0;
    path.crossed = path.behindPane = false;
    path.first = noScattering();
    path.rough = false;
    path.clamped = 0.0;
    path.amongFaces = false;
    return path;
}

// Behind the films of one tile, for Renderer::trace; the step after a path's last has t < 0.
void recordStep(uint step, vec3 position, float t, PathState path, uint primitive) {
    uint at = FILM_STRIDE * pass.tileSize * pass.tileSize + step * TRACE_TEXELS;
    film[at] = vec4(position, t);
    film[at + 1u] = vec4(path.throughput, path.pdf);
    film[at + 2u] = vec4(path.radiance, uintBitsToFloat(primitive));
}

// The bounce limit ends a path that still carries so much.
void truncate(float throughput) {
    truncatedCount++;
    add(truncatedThroughput, throughput);
}

PathSample traceSample(SampleKey key, vec3 origin, vec3 direction) {
    PathSample result = PathSample(vec3(0), vec3(0), vec3(0), 0.0, 0.0);
    PathState path = startPath(key, origin, direction);
    for (;; path.bounce++) {
        Hit hit;
        path.ray.key = cutoutKey(key, path.bounce);
        rayCount++;
        if (has(FEATURE_CULLING) && path.bounce > 0u) {
            path.ray.culls = cullsAll();
            path.ray.tMin = 0.0;
            path.ray.tMax = INFINITY;
        }
        FogFlight flight;
        if (has(FEATURE_FOG)) {
            flight = fogFlight(path.throughput, path.medium, path.ray, key, path.bounce);
            // The camera's ray goes on to the first surface, for the channels that show that.
            if (path.bounce > 0u) path.ray.tMax = flight.reach;
        }
        bool found = meet(path, hit);
        bool inFog = has(FEATURE_FOG) && passFog(path.throughput, flight, found ? hit.t : INFINITY);
        if (!found && !inFog) {
            addEnvironment(path);
            if (has(FEATURE_TRACE)) recordStep(path.bounce, path.ray.direction, INFINITY, path, NO_INDEX);
            break;
        }
        vec3 worldWo = -path.ray.direction;
        Surface s;
        MaterialPoint m;
        if (found) {
            s = arrive(path, hit);
            m = materialAt(s);
            if (has(FEATURE_REGULARISATION) && path.rough) regularise(m, parameters.regularisation);
            if (path.bounce == 0u) {
                result.albedo = m.baseColor;
                result.normal = s.frame[2];
                result.depth = hit.t;
                result.alpha = 1.0;
                noteFirstSurface(s);
            }
        }
        if (inFog) {
            s = fogPoint(path.ray.origin + flight.reach * path.ray.direction);
        } else {
            if (has(FEATURE_ATTENUATION)) path.throughput *= exp(-path.medium.absorption * hit.t);
            if (has(FEATURE_UNLIT) && (m.flags & MATERIAL_UNLIT) != 0u) {
                gather(path, m.baseColor, scatteringsOfLight(path));
                break;
            }
            addEmission(path, s, m, hit.t);
        }
        if (has(FEATURE_TRACE)) recordStep(path.bounce, s.position, inFog ? flight.reach : hit.t, path, s.primitive);
        bool last = scatterings(path) >= parameters.maxBounces;  // then it may still go straight on
        if (last && !(has(FEATURE_GLASS_SHADOWS) && !inFog && (m.flags & MATERIAL_PANE) != 0u)) {
            truncate(maxComponent(path.throughput));
            break;
        }

        vec3 wo = worldWo * s.frame;
        Bsdf bsdf;
        if (!inFog) {
            if (wo.z <= 0.0) break;
            if (has(FEATURE_DISPERSION) && m.dispersion > 0.0 && m.transmission > 0.0) disperse(path, m, key);
            if (mediaNest()) setRelativeIor(path.medium.stack, s, path.channel, m);
            bsdf = bsdfAt(m, wo, s.frontFace);
        }
        if (hasLights() && !(has(FEATURE_GLASS_SHADOWS) && last)) {
            FirstScattering parts;
            vec3 light = directLight(key, path.bounce, s, bsdf, wo, lightWay(path, s, m, bsdf), parts);
            if (has(FEATURE_LIGHT_PATHS) && path.bounce == 0u) path.first = sharesOf(parts, light);
            gather(path, light, scatteringsOfLight(path) + 1u);
        }

        uvec4 bits = randomBits(key, bounceDimension(path.bounce, inFog ? DIMENSION_PHASE : DIMENSION_BSDF));
        vec4 u = vec4(unitFloat(bits.xy), unitFloat(bits.zw));
        float carried = maxComponent(path.throughput);
        if (!(inFog ? scatterInFog(path, s.position, u) : scatter(path, s, bsdf, m, wo, u))) break;
        if (facesHaveOrder())
            path.amongFaces = !inFog && nextAmongFaces(s, path.ray.direction, cutoutKey(key, path.bounce + 1u), path.next);
        if (has(FEATURE_GLASS_SHADOWS) && path.crossed) continue;
        if (has(FEATURE_GLASS_SHADOWS) && last) {
            truncate(carried);
            break;
        }
        if (scatterings(path) + 1u >= parameters.rouletteStart && !russianRoulette(path, u.w)) break;
    }
    if (has(FEATURE_FAULT_INJECTION) && randomBits(key, DIMENSION_INJECTION).x < INJECTION_THRESHOLD)
        path.radiance = vec3(uintBitsToFloat(0x7fc00000u));
    if (has(FEATURE_TRACE)) recordStep(path.bounce + 1u, path.ray.origin, -1.0, path, NO_INDEX);
    if (has(FEATURE_CLAMP) && path.clamped > 0.0) {
        clampedCount++;
        add(clampedRadiance, path.clamped);
    }
    result.radiance = path.radiance;
    return result;
}

#include "sample_loop.glsl"
