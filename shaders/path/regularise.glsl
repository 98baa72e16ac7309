// Kaplanyan, Dachsbacher 2013: behind a rough surface nothing is a mirror, so that lights are found which only a mirror
// would show. Blurs caustics. Behind FEATURE_REGULARISATION.
#ifndef REGULARISE_GLSL
#define REGULARISE_GLSL

void regularise(inout MaterialPoint m, float least) {
    m.alpha = max(m.alpha, least);
    m.alphaT = max(m.alphaT, least);
    m.clearcoatAlpha = max(m.clearcoatAlpha, least);
}

#endif
