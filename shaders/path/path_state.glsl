// What a path carries from surface to surface.
#ifndef PATH_STATE_GLSL
#define PATH_STATE_GLSL

#include "light_paths.glsl"
#include "medium.glsl"

struct PathState {
    Ray ray;
    vec3 throughput;
    vec3 radiance;
    Medium medium;      // that the ray is in
    float pdf;          // of the ray's direction; what lights weigh against
    float etaScale;     // squared refraction compressions so far, kept out of Russian roulette
    bool delta;         // no light sampling could have found this direction
    vec3 from;          // where the path scattered last, and lightSide there: what light sampling went by
    vec3 side;
    uint channel;       // the only one left after dispersion; 3: all
    uint bounce;        // how many surfaces and points in fog have sent it on; each has random numbers of its own
    uint straight;      // FEATURE_GLASS_SHADOWS: panes of them that it crossed, which are no scattering
    uint panes;         // likewise, since it scattered last
    float passed;       // likewise, m from where it scattered last to the ray's origin
    bool crossed;       // likewise, by the last of them
    bool behindPane;    // likewise, before it scattered at all
    FirstScattering first;  // with FEATURE_LIGHT_PATHS
    bool rough;         // FEATURE_REGULARISATION: at a surface that was no mirror
    float clamped;      // FEATURE_CLAMP: luminance taken away
    bool amongFaces;    // FEATURE_COINCIDENT_FACES: what the ray meets is known and is where it starts:
    Hit next;
};

// How many times it has scattered.
uint scatterings(PathState path) { return has(FEATURE_GLASS_SHADOWS) ? path.bounce - path.straight : path.bounce; }

// Likewise as gather wants it. What the camera sees through a pane came through that, however many panes follow.
uint scatteringsOfLight(PathState path) {
    return has(FEATURE_GLASS_SHADOWS) && path.behindPane ? scatterings(path) + 1u : scatterings(path);
}

// Every light that reaches the camera comes by here. `scatterings`: how often it did between light and camera.
void gather(inout PathState path, vec3 light, uint scatterings) {
    // Its bits must not depend on what else asks for it: some compilers would fuse it with the sum below, or not.
    precise vec3 radiance = path.throughput * light;
    if (has(FEATURE_CLAMP) && scatterings > 0u) {
        float bound = scatterings == 1u ? parameters.clampDirect : parameters.clampIndirect;
        float largest = maxComponent(radiance);
        if (largest > bound) {
            path.clamped += luminance(radiance) * (1.0 - bound / largest);
            radiance *= bound / largest;
        }
    }
    if (has(FEATURE_LIGHT_PATHS)) splitLight(path.first, radiance, scatterings);
    path.radiance += radiance;
}

#endif
