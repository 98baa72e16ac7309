// A rough surface of microfacets: which normals there are, which a direction sees, and how to draw one.
// Normals of all distributions are drawn as GGX's visible ones of the same α: no other has longer tails, and
// the ratio of any to it is bounded (Beckmann 4/e), grazing angles included.
#ifndef FACETS_GLSL
#define FACETS_GLSL

#include "ggx.glsl"
#include "beckmann.glsl"

struct Facets {
    vec2 alpha;  // along the tangent and across it
    uint flags;  // MATERIAL_BECKMANN, MATERIAL_PHONG; neither: GGX
};

bool isPhong(Facets f) { return has(FEATURE_PHONG) && (f.flags & MATERIAL_PHONG) != 0u; }
bool isBeckmann(Facets f) { return has(FEATURE_BECKMANN) && (f.flags & MATERIAL_BECKMANN) != 0u; }
bool isStretched(Facets f) { return has(FEATURE_ANISOTROPY) && f.alpha.x != f.alpha.y; }

// The one α that stands for both where a model knows one, Phong's and the tables': the root of the mean square.
float meanAlpha(Facets f) { return isStretched(f) ? sqrt(0.5 * dot(f.alpha, f.alpha)) : f.alpha.y; }

// How far the table of isotropic albedos is from a stretched surface: 0 for one that is not.
float stretchOf(Facets f) { return isStretched(f) ? 1.0 - min(f.alpha.x, f.alpha.y) / max(f.alpha.x, f.alpha.y) : 0.0; }

// Roughness in the plane of w and the normal.
float alphaInPlane(Facets f, vec3 w) {
    float across = dot(w.xy, w.xy);
    return across > 0.0 ? length(f.alpha * w.xy) * inversesqrt(across) : meanAlpha(f);
}

// The α whose isotropic albedo stands for that of a stretched surface seen along w. Masking goes by the roughness in the
// plane of w, and half of that is a bound: facets tilted sideways reflect at grazing angles what those of the plane would
// shadow (all of αx ≥ αy from 1e-3 to 1 and index 1.1 to 2.4: true albedo above by 0.013 at most and only below cosθ =
// 1e-3, but along grooves, see albedosAt; below by up to 0.44 across grooves). sqrt((αx² + αy²) / 2) would be too low by
// 0.7.
float stretchedAlpha(Facets f, vec3 w) { return alphaInPlane(f, w) * (1.0 - 0.5 * stretchOf(f)); }

float facetD(Facets f, vec3 h) {
    if (isPhong(f)) return phongD(h, f.alpha.y);
    if (isBeckmann(f)) return beckmannD(h, f.alpha);
    return isStretched(f) ? ggxD(h, f.alpha) : ggxD(h, f.alpha.y);
}

float facetStretch(Facets f, vec3 w) { return isStretched(f) ? ggxStretch(w, f.alpha) : ggxStretch(w, f.alpha.y); }

// Height-correlated masking and shadowing over 4 cosθo cosθi.
float facetVisibility(Facets f, vec3 wo, vec3 wi) {
    if (isPhong(f) || isBeckmann(f)) {
        float lambda = isPhong(f) ? phongLambda(wo, f.alpha.y) + phongLambda(wi, f.alpha.y)
                                  : beckmannLambda(wo, f.alpha) + beckmannLambda(wi, f.alpha);
        float cosines = 4.0 * abs(wo.z * wi.z) * (1.0 + lambda);
        return cosines > 0.0 ? 1.0 / cosines : 0.0;
    }
    return ggxVisibility(abs(wo.z), abs(wi.z), facetStretch(f, wo), facetStretch(f, wi));
}

// Density of facetSample, 1/sr.
float facetPdf(Facets f, vec3 wo, vec3 h) {
    float sum = abs(wo.z) + facetStretch(f, wo);
    float d = isStretched(f) ? ggxD(h, f.alpha) : ggxD(h, f.alpha.y);
    return sum > 0.0 ? 2.0 * d * abs(dot(wo, h)) / sum : 0.0;
}

vec3 facetSample(Facets f, vec3 wo, vec2 u) { return ggxSampleVisible(wo, f.alpha, u); }

#endif
