// The environment as the integrators see it that do not trace paths: irradiance without asking what hides it, and what
// a ray that leaves the scene meets.
#ifndef AMBIENT_GLSL
#define AMBIENT_GLSL

// W/m² on a surface with normal n, per channel, from nine coefficients of spherical harmonics (Ramamoorthi, Hanrahan
// 2001) computed on the host (worker/render/environment_irradiance.h).
vec3 environmentIrradiance(vec3 n) {
    if (!has(FEATURE_ENVIRONMENT)) return vec3(0);
    if (environmentTurned()) {
        float angle = parameters.environmentTurns * TWO_PI;
        float c = cos(angle), s = sin(angle);
        n.xz = vec2(c * n.x - s * n.z, s * n.x + c * n.z);
    }
    vec3 sum = parameters.irradiance[0].rgb;
    sum += parameters.irradiance[1].rgb * n.y + parameters.irradiance[2].rgb * n.z + parameters.irradiance[3].rgb * n.x;
    sum += parameters.irradiance[4].rgb * (n.x * n.y) + parameters.irradiance[5].rgb * (n.y * n.z);
    sum += parameters.irradiance[6].rgb * (3.0 * n.z * n.z - 1.0) + parameters.irradiance[7].rgb * (n.x * n.z);
    sum += parameters.irradiance[8].rgb * (n.x * n.x - n.y * n.y);
    return max(sum, vec3(0));  // the series rings below zero opposite a small bright source
}

vec3 environmentRadiance(vec3 direction) { return has(FEATURE_ENVIRONMENT) ? environmentAlong(direction).rgb : vec3(0); }

// What a ray that leaves the scene meets, disks of suns included. `seen`: by the camera itself.
vec3 radianceFromOutside(vec3 direction, bool seen) {
    if (has(FEATURE_HIDDEN_ENVIRONMENT) && parameters.environmentHidden != 0.0 && seen) return vec3(0);
    vec3 sum = environmentRadiance(direction);
    if (!has(FEATURE_SUN_LIGHTS)) return sum;
    for (uint i = 0u; i < parameters.sunCount; i++) {
        LightRecord sun = loadLightRecord(parameters.firstSun + i);
        if (meetsSunLight(sun, direction)) sum += lightValue(sun);
    }
    return sum;
}

#endif
