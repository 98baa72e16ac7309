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
    uint bounce;        // how many times it has scattered
    FirstScattering first;  // with FEATURE_LIGHT_PATHS
    bool rough;         // FEATURE_REGULARISATION: at a surface that was no mirror
    float clamped;      // FEATURE_CLAMP: luminance taken away
};

// Every light that reaches the camera comes by here. `scatterings`: how often it did between light and camera.
void gather(inout PathState path, vec3 light, uint scatterings) {
    // Its bits must not depend on what else asks for it: some compilers would fuse it with the sum below, or not.
    precise vec3 radiance = path.throughput * light;
    if (has(FEATURE_CLAMP) && scatterings > 0u) {
        float bound = scatterings == 1u ? parameters.bounds.x : parameters.bounds.y;
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
