// What of a light's sample comes to a path through smooth thin-walled glass. Such light also comes by the path's own ray,
// which crosses a pane as if it were not there (crossPane): both ways know the same surfaces, and the pdfs of the last
// scattering weigh them against each other.
#ifndef PATH_GLASS_SHADOW_GLSL
#define PATH_GLASS_SHADOW_GLSL

#include "../glass_shadow.glsl"
#include "medium.glsl"
#include "regularise.glsl"

vec3 throughPane(Surface s, vec3 direction, Medium medium, uint channel) {
    MaterialPoint m = materialAt(s);
    // (Light sampling serves rough lobes alone, behind which a path would regularise too.)
    if (has(FEATURE_REGULARISATION)) regularise(m, parameters.regularisation);
    if (mediaNest()) setRelativeIor(medium.stack, s, channel, m);
    return straightThrough(m, -normalize(direction) * s.frame, s.frontFace);
}

// `medium` and colour `channel`: of the path at the surface `from`.
vec3 throughPanes(LightSample l, Surface from, uint key, Medium medium, uint channel) {
    Ray ray = shadowRay(l, from, key);
    vec3 left = vec3(1);
    Surface s;
    bool pane;
    for (uint panes = 0u; shadowMeets(l, ray, from, s, pane); panes++) {
        if (panes == MOST_PANES || !pane) return vec3(0);
        left *= throughPane(s, ray.direction, medium, channel);
        if (!(maxComponent(left) > 0.0)) return vec3(0);
        goBehind(s, l, ray);
        from = s;
    }
    return left;
}

#endif
