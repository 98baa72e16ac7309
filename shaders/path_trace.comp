#version 460
// The path tracer: one invocation per pixel, several samples per dispatch. Paths start at the camera;
// at each surface lights are sampled (next event estimation) and the BSDF is sampled, both weighted
// by the power heuristic unless the settings leave one of them out. Without bias but for the bounce limit that the job sets.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform PassBlock { PassConstants pass; };
layout(std430, binding = BINDING_TILES) readonly buffer Tiles { uvec4 tiles[]; };
layout(std430, binding = BINDING_FILM) buffer Film { vec4 film[]; };
layout(std430, binding = BINDING_COUNTERS) buffer Counters { uint counters[]; };

uint rayCount = 0u;
uint rejectedCount = 0u, truncatedCount = 0u;  // of paths, see TILE_* in gpu_types.h

bool acceptHit(uint primitive, vec2 barycentrics, uint key);
#include "intersect.glsl"
#include "texture.glsl"
#include "surface.glsl"
#include "material.glsl"

#include "bsdf/bsdf.glsl"
#include "lights/light.glsl"
#include "camera.glsl"
#include "pixel_filter.glsl"
#include "film.glsl"

// What decides at cut-out surfaces along the rays of a bounce.
uint cutoutKey(SampleKey key, uint bounce) {
    return has(FEATURE_CUTOUT) ? randomBits(key, bounceDimension(bounce, DIMENSION_CUTOUT)).x : 0u;
}

bool occluded(LightSample l, uint primitive, uint key) {
    Ray ray;
    ray.origin = l.origin;
    ray.tMin = 0.0;
    ray.direction = l.infinite ? l.wi : l.target - l.origin;
    // Not the light itself: traversal has its t to within γ(10), and a light in a plane through the origin has no error
    // of its own that would move the target off it.
    ray.tMax = l.infinite ? INFINITY : 1.0 - gammaBound(10.0);
    ray.skipPrimitive = primitive;
    ray.key = key;
    rayCount++;
    return anyHit(ray);
}

// The side on which a surface sees lights, for lightPmf; zero for both.
vec3 lightSide(Surface s, Bsdf bsdf) {
    bool through = transmits(bsdf.face) || (has(FEATURE_DIFFUSE_TRANSMISSION) && maxComponent(bsdf.diffuse.back) > 0.0);
    return through ? vec3(0) : s.geometricNormal;
}

// Absorption on either side of a surface: on wo's, and behind it.
struct Media {
    vec3 near, far;
};

Media mediaAt(vec3 near, Surface s, MaterialPoint m, Bsdf bsdf) {
    return Media(near, bsdf.face.thin ? near : s.frontFace ? m.absorption : vec3(0));
}

// What a sampled point of a light sends along the path, weighted against the BSDF's finding it.
vec3 lightThrough(LightSample l, SampleKey key, uint bounce, Surface s, Bsdf bsdf, vec3 wo, Media media) {
    vec3 wi = l.wi * s.frame;
    // Light must not leak through the surface that the shading normal only pretends to be.
    if (dot(l.wi, s.geometricNormal) * wi.z <= 0.0) return vec3(0);
    if (has(FEATURE_BSDF_SAMPLING_ONLY) && l.pdf > 0.0) return vec3(0);
    float pdf;
    vec3 f = bsdfEval(bsdf, wo, wi, pdf);
    if (!(maxComponent(f) > 0.0)) return vec3(0);
    float weight = has(FEATURE_LIGHT_SAMPLING_ONLY) ? 1.0 : powerHeuristic(l.pdf, pdf);
    vec3 contribution = l.pdf > 0.0 ? f * l.radiance * (weight / l.pdf) : f * l.radiance;
    if (has(FEATURE_ATTENUATION) && !l.infinite)
        contribution *= exp(-(wi.z > 0.0 ? media.near : media.far) * distance(l.origin, l.target));
    return maxComponent(contribution) > 0.0 && !occluded(l, s.primitive, cutoutKey(key, bounce)) ? contribution : vec3(0);
}

// Light that arrives straight from the lights.
vec3 directLight(SampleKey key, uint bounce, Surface s, Bsdf bsdf, vec3 wo, Media media) {
    // Of the kinds of lights only those without extent are left to this.
    if (has(FEATURE_BSDF_SAMPLING_ONLY) && !has(FEATURE_PUNCTUAL_LIGHTS)) return vec3(0);
    LightSample l;
    if (has(FEATURE_ALL_LIGHTS)) {
        vec3 sum = vec3(0);
        for (uint light = 0u; light < parameters.path.z; light++)
            if (sampleEachLight(light, key, bounce, s, l)) sum += lightThrough(l, key, bounce, s, bsdf, wo, media);
        return sum;
    }
    if (!sampleLight(key, bounce, s, lightSide(s, bsdf), l)) return vec3(0);
    return lightThrough(l, key, bounce, s, bsdf, wo, media);
}

struct PathState {
    Ray ray;
    vec3 throughput;
    vec3 radiance;
    vec3 absorption;    // of the medium the ray is in
    float pdf;          // of the ray's direction; what lights weigh against
    float etaScale;     // squared refraction compressions so far, kept out of Russian roulette
    bool delta;         // no light sampling could have found this direction
    vec3 from;          // where the path scattered last, and lightSide there: what light sampling went by
    vec3 side;
    uint channel;       // the only one left after dispersion; 3: all
};

// Weight of light that the path met by itself, which light sampling finds with lightPdf.
float emissionWeight(PathState path, float lightPdf) {
    if (path.delta || has(FEATURE_BSDF_SAMPLING_ONLY)) return 1.0;
    if (has(FEATURE_LIGHT_SAMPLING_ONLY)) return lightPdf > 0.0 ? 0.0 : 1.0;
    return powerHeuristic(path.pdf, lightPdf);
}

void addSuns(inout PathState path) {
    if (!has(FEATURE_SUN_LIGHTS)) return;
    for (uint i = 0u; i < parameters.environment.w; i++) {
        uint light = parameters.environment.z + i;
        vec3 towards = -lightTexel(light, 2u).xyz;
        float h = lightTexel(light, 3u).x;
        if (!sunCovers(towards, h, path.ray.direction)) continue;
        float pmf = lightPmf(light, uintBitsToFloat(LOAD(lightTexels, light * LIGHT_TEXELS).z), path.from, path.side);
        vec3 radiance = vec3(lightTexel(light, 1u).w, lightTexel(light, 2u).w, lightTexel(light, 3u).w);
        path.radiance += path.throughput * radiance * emissionWeight(path, pmf * sunPdf(h));
    }
}

// What a ray that leaves the scene meets.
void addEnvironment(inout PathState path, uint bounce) {
    if (has(FEATURE_HIDDEN_ENVIRONMENT) && parameters.environmentPdf.w != 0.0 && bounce == 0u) return;
    addSuns(path);
    if (!has(FEATURE_ENVIRONMENT)) return;
    vec4 environment = environmentAlong(path.ray.direction);
    float weight = path.delta ? 1.0 : emissionWeight(path, environment.a * environmentPmf(path.from, path.side));
    path.radiance += path.throughput * environment.rgb * weight;
}

void addEmission(inout PathState path, Surface s, MaterialPoint m, float t) {
    if (!hasEmitters() || (m.flags & MATERIAL_EMISSIVE) == 0u) return;
    if (!emitsTowards(m.flags, s.frontFace)) return;
    float cosine = abs(dot(s.geometricNormal, path.ray.direction));
    float weight = path.delta ? 1.0 : emissionWeight(path, emitterPdf(s.primitive, path.from, path.side, t, cosine));
    path.radiance += path.throughput * m.emission * (weight * emissionThroughCoat(s.material, s.uv0, s.uv1, cosine));
}

// Ends dim paths at random and makes up for it in those that survive, whose throughput is then 1: a survival less than
// the throughput would let the weights of long paths grow without bound. False: the path ends.
bool russianRoulette(inout PathState path, float u) {
    float survival = maxComponent(path.throughput) * path.etaScale;
    if (u >= survival) return false;
    if (survival < 1.0) path.throughput /= survival;
    return true;
}

// Scatters the path at a surface. False: the path ends.
bool scatter(inout PathState path, Surface s, Bsdf bsdf, MaterialPoint m, vec3 wo, vec4 u) {
    BsdfSample b;
    bool found = bsdfSample(bsdf, wo, u.xyz, b);
    vec3 direction = found ? normalize(s.frame * b.wi) : vec3(0);
    if (!found || dot(direction, s.geometricNormal) * b.wi.z <= 0.0) {
        rejectedCount++;
        return false;
    }
    path.throughput *= b.weight;
    path.pdf = b.pdf;
    path.delta = b.delta;
    path.from = s.position;
    path.side = lightSide(s, bsdf);
    if ((has(FEATURE_TRANSMISSION) || has(FEATURE_DIFFUSE_TRANSMISSION)) && b.wi.z < 0.0 && !bsdf.face.thin) {
        if (transmits(bsdf.face)) path.etaScale *= bsdf.face.eta * bsdf.face.eta;
        if (has(FEATURE_ATTENUATION)) path.absorption = mediaAt(path.absorption, s, m, bsdf).far;
    }
    path.ray.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, direction);
    path.ray.direction = direction;
    path.ray.skipPrimitive = s.primitive;
    return maxComponent(path.throughput) > 0.0;
}

// KHR_materials_dispersion: red and blue see an index of refraction that is half the spread less or more. From its
// first dispersive surface on a path follows one channel, chosen uniformly and weighted up.
void disperse(inout PathState path, inout MaterialPoint m, SampleKey key) {
    if (path.channel == 3u) {
        path.channel = min(uint(3.0 * unitFloat(randomBits(key, DIMENSION_CHANNEL).x)), 2u);
        vec3 kept = vec3(0);
        kept[path.channel] = 3.0;
        path.throughput *= kept;
    }
    m.ior += (float(path.channel) - 1.0) * (m.ior - 1.0) * 0.025 * m.dispersion;
}

// Behind the films of one tile, for Renderer::trace; the step after a path's last has t < 0.
void recordStep(uint step, vec3 position, float t, PathState path, uint primitive) {
    uint at = 4u * pass.tileSize * pass.tileSize + step * TRACE_TEXELS;
    film[at] = vec4(position, t);
    film[at + 1u] = vec4(path.throughput, path.pdf);
    film[at + 2u] = vec4(path.radiance, uintBitsToFloat(primitive));
}

PathSample tracePath(SampleKey key, vec3 origin, vec3 direction) {
    PathSample result = PathSample(vec3(0), vec3(0), vec3(0), 0.0, 0.0);
    PathState path;
    path.ray = Ray(origin, 0.0, direction, INFINITY, kNoPrimitive, 0u);
    path.throughput = vec3(1);
    path.radiance = vec3(0);
    path.absorption = vec3(0);
    path.pdf = 0.0;
    path.etaScale = 1.0;
    path.delta = true;
    path.from = path.side = vec3(0);
    path.channel = 3u;

    uint bounce = 0u;
    for (;; bounce++) {
        Hit hit;
        path.ray.key = cutoutKey(key, bounce);
        rayCount++;
        if (!closestHit(path.ray, hit)) {
            addEnvironment(path, bounce);
            if (has(FEATURE_TRACE)) recordStep(bounce, path.ray.direction, INFINITY, path, NO_INDEX);
            break;
        }
        if (has(FEATURE_ATTENUATION)) path.throughput *= exp(-path.absorption * hit.t);
        vec3 worldWo = -path.ray.direction;
        Surface s = surfaceAt(hit, path.ray);
        MaterialPoint m = materialAt(s);
        if (bounce == 0u) {
            result.albedo = m.baseColor;
            result.normal = s.frame[2];
            result.depth = hit.t;
            result.alpha = 1.0;
        }
        if (has(FEATURE_UNLIT) && (m.flags & MATERIAL_UNLIT) != 0u) {
            path.radiance += path.throughput * m.baseColor;
            break;
        }
        addEmission(path, s, m, hit.t);
        if (has(FEATURE_TRACE)) recordStep(bounce, s.position, hit.t, path, s.primitive);
        if (bounce >= parameters.path.x) {
            truncatedCount++;
            break;
        }

        vec3 wo = worldWo * s.frame;
        if (wo.z <= 0.0) break;
        if (has(FEATURE_DISPERSION) && m.dispersion > 0.0 && m.transmission > 0.0) disperse(path, m, key);
        Bsdf bsdf = bsdfAt(m, wo, s.frontFace);
        if (hasLights()) path.radiance += path.throughput * directLight(key, bounce, s, bsdf, wo, mediaAt(path.absorption, s, m, bsdf));

        uvec4 bits = randomBits(key, bounceDimension(bounce, DIMENSION_BSDF));
        vec4 u = vec4(unitFloat(bits.xy), unitFloat(bits.zw));
        if (!scatter(path, s, bsdf, m, wo, u)) break;
        if (bounce + 1u >= parameters.path.y && !russianRoulette(path, u.w)) break;
    }
    if (has(FEATURE_FAULT_INJECTION) && randomBits(key, DIMENSION_INJECTION).x < INJECTION_THRESHOLD)
        path.radiance = vec3(uintBitsToFloat(0x7fc00000u));
    if (has(FEATURE_TRACE)) recordStep(bounce + 1u, path.ray.origin, -1.0, path, NO_INDEX);
    result.radiance = path.radiance;
    return result;
}

PathSample renderSample(uvec2 pixel, SampleKey key) {
    vec2 u = unitFloat(randomBits(key, DIMENSION_PIXEL).xy);
    vec3 origin, direction;
    cameraRay(key, vec2(pixel) + filterSample(u), origin, direction);
    return tracePath(key, origin, direction);
}

void main() {
    uvec2 inTile = gl_GlobalInvocationID.xy;
    uvec4 tile = tiles[gl_WorkGroupID.z];
    if (any(greaterThanEqual(inTile, tile.zw))) return;
    uvec2 pixel = tile.xy + inTile;
    uint at = gl_WorkGroupID.z * pass.tileSize * pass.tileSize + inTile.y * pass.tileSize + inTile.x;

    FilmPixel result = emptyPixel();
    if (pass.continued != 0u) result = loadPixel(at);
    SampleKey key;
    key.pixel = pixel.x | pixel.y << 16u;
    key.stream = streamKey(parameters.image.z, parameters.image.w);
    uint dropped = 0u;
    for (uint i = 0u; i < pass.sampleCount; i++) {
        key.index = pass.firstSample + i * pass.sampleStride;
        PathSample s = renderSample(pixel, key);
        // A sample that is not finite leaves with its weight and is counted, never hidden.
        if (isFinite(s.radiance)) {
            addSample(result, s);
        } else {
            dropped++;
            uint record = atomicAdd(counters[COUNTER_RECORDED], 1u);
            if (record < RECORDED_SAMPLES) {
                counters[COUNTER_FIRST_DROPPED + 2u * record] = key.pixel;
                counters[COUNTER_FIRST_DROPPED + 2u * record + 1u] = key.index;
            }
        }
    }
    storePixel(at, result);
    atomicAdd(counters[COUNTER_RAYS], rayCount);
    if (dropped != 0u) atomicAdd(counters[COUNTER_DROPPED_SAMPLES], dropped);
    uint ofTile = COUNTER_COUNT + gl_WorkGroupID.z * TILE_COUNTERS;
    if (rejectedCount != 0u) atomicAdd(counters[ofTile + TILE_REJECTED], rejectedCount);
    if (truncatedCount != 0u) atomicAdd(counters[ofTile + TILE_TRUNCATED], truncatedCount);
}
