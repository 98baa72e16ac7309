// What sampling a light at a surface point gives.
#ifndef LIGHT_SAMPLE_GLSL
#define LIGHT_SAMPLE_GLSL

struct LightSample {
    vec3 target;     // end of the shadow ray from `origin`; infinitely far lights: a direction
    vec3 origin;
    bool infinite;
    vec3 wi;         // unit, from the surface
    vec3 radiance;   // over the selection probability where `pdf` is 0
    float pdf;       // solid angle times selection, 1/sr; 0 for lights that no ray can meet
};

// Radiance; of punctual lights intensity, of directional ones irradiance.
vec3 lightValue(LightRecord light) { return vec3(light.red, light.green, light.blue); }

#endif
