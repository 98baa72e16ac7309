// Light that a path meets by itself, weighted against light sampling's finding it.
#ifndef FOUND_LIGHT_GLSL
#define FOUND_LIGHT_GLSL

#include "path_state.glsl"

// Weight of light that the path met by itself, which light sampling finds with lightPdf.
float emissionWeight(PathState path, float lightPdf) {
    if (path.delta || lightsByBsdf()) return 1.0;
    if (lightsAlone()) return lightPdf > 0.0 ? 0.0 : 1.0;
    return powerHeuristic(path.pdf, lightPdf);
}

void addSuns(inout PathState path) {
    if (!has(FEATURE_SUN_LIGHTS)) return;
    for (uint i = 0u; i < parameters.sunCount; i++) {
        uint light = parameters.firstSun + i;
        LightRecord sun = loadLightRecord(light);
        if (!meetsSunLight(sun, path.ray.direction)) continue;
        float pmf = lightPmf(light, sun.pmf, path.from, path.side);
        gather(path, lightValue(sun) * emissionWeight(path, pmf * sunLightPdf(sun)), scatteringsOfLight(path));
    }
}

// What a ray that leaves the scene meets.
void addEnvironment(inout PathState path) {
    if (has(FEATURE_HIDDEN_ENVIRONMENT) && parameters.environmentHidden != 0.0 && path.bounce == 0u) return;
    addSuns(path);
    if (!has(FEATURE_ENVIRONMENT)) return;
    vec4 environment = environmentAlong(path.ray.direction);
    float weight = path.delta ? 1.0 : emissionWeight(path, environment.a * environmentPmf(path.from, path.side));
    gather(path, environment.rgb * weight, scatteringsOfLight(path));
}

void addEmission(inout PathState path, Surface s, MaterialPoint m, float t) {
    if (!hasEmitters() || (m.flags & MATERIAL_EMISSIVE) == 0u) return;
    if (!emitsTowards(m.flags, s.frontFace)) return;
    float cosine = abs(dot(s.geometricNormal, path.ray.direction));
    if (has(FEATURE_GLASS_SHADOWS)) t += path.passed;
    bool throughVeil = has(FEATURE_CUTOUT) && isCutOut(m.flags) && !s.frontFace;
    float weight = path.delta ? 1.0 : emissionWeight(path, emitterPdf(s.primitive, path.from, path.side, t, cosine, throughVeil));
    gather(path, m.emission * (weight * emissionThroughCoat(s.material, s.uv0, s.uv1, cosine)), scatteringsOfLight(path));
}

#endif
