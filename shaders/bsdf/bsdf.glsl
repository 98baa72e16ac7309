// The material model as a sum of lobes, from the top of the stack down:
//
//   coat          clearcoat · microfacets (clearcoat.glsl)
//   sheen         sheenColor · cloth (sheen.glsl)
//   interface     reflection and transmission of the microfacets between air and base, and what scatters
//                 more than once between them
//   diffuse base  front and back (diffuse.glsl)
//
// Interface (interface.glsl): F = mix(dielectric, metal, metallic) is reflected; of the rest, the
// dielectric's share `transmission` passes, tinted by the base colour, refracted or thin-walled. The diffuse
// base gets what the rough interface above it lets through in both directions (Kelemen, Szirmay-Kalos 2001;
// compensation.glsl), which keeps it reciprocal and the sum from exceeding 1.
//
// Layers: what lies below coat and sheen is scaled by what they let through as seen from wo alone, as glTF
// and OpenPBR have it: (1 − clearcoat · Ecoat(wo)) (1 − Esheen(wo)). A white stack returns
// exactly all light; the price is that the sum is not reciprocal though every lobe is.
//
// `bsdfSample` chooses a lobe by its probability and evaluates all. A lobe that is absent has probability 0
// and no share in any sum, so kernels with and without its code give the same bits. Directions are in the
// shading frame with wo.z > 0. `eval` is BSDF times cosine.
#ifndef BSDF_GLSL
#define BSDF_GLSL

#include "diffuse.glsl"
#include "facets.glsl"
#include "interface.glsl"
#include "reflection.glsl"
#include "transmission.glsl"
#include "compensation.glsl"
#include "clearcoat.glsl"
#include "sheen.glsl"

struct Bsdf {
    Interface face;
    Facets facets;
    float alpha;           // that the albedo tables are asked for
    uint albedoTable;
    bool mirror;           // reflection and transmission are delta lobes
    DiffuseBase diffuse;   // with the interface's factor of wo
    Compensation compensation;
    Coat coat;
    Sheen sheen;
    float belowCoat;       // what the coat lets through to the sheen
    float below;           // what both layers let through to the interface
    // Probabilities of sampling; their sum is 1.
    float coatChance, sheenChance, backChance, frontChance, facetChance;
};

struct BsdfSample {
    vec3 wi;
    vec3 weight;  // BSDF times cosine over pdf
    float pdf;    // solid angle, 1/sr; of all lobes together; not used for delta lobes
    bool delta;
    bool blocked;  // of no sample: the facet drawn sends light into the surface, which is the model's loss and no fault
};

#define hasLayers() \
    ((featureBit(FEATURE_CLEARCOAT) | featureBit(FEATURE_SHEEN) | featureBit(FEATURE_DISNEY_SHEEN)) != 0u)
#define hasSheen() ((featureBit(FEATURE_SHEEN) | featureBit(FEATURE_DISNEY_SHEEN)) != 0u)

#define hasMultiple() ((featureBit(FEATURE_SPECULAR) & featureBit(FEATURE_ENERGY_COMPENSATION)) != 0u)
#define hasBack()                                                                                        \
    ((featureBit(FEATURE_DIFFUSE_TRANSMISSION) | (featureBit(FEATURE_SPECULAR) & featureBit(FEATURE_ENERGY_COMPENSATION) & \
                                                  featureBit(FEATURE_TRANSMISSION))) != 0u)

// The interface's albedos (Ed, E1) for a direction. Of stretched facets, whose albedo varies around the normal, bounds:
// what stretchedAlpha leaves out at grazing angles is added where an albedo is neither 0 nor 1. Along grooves that are
// as rough across as α = 0.7 or more it leaves out the most (0.05 of all light).
vec2 albedosAt(Bsdf b, vec3 w) {
    if (b.albedoTable == NO_INDEX) return vec2(0);
    float stretch = has(FEATURE_ANISOTROPY) && !b.mirror ? stretchOf(b.facets) : 0.0;
    if (!has(FEATURE_ANISOTROPY) || stretch == 0.0) return albedoPair(b.albedoTable, abs(w.z), b.alpha, needsBothAlbedos());
    float plane = alphaInPlane(b.facets, w), most = max(b.facets.alpha.x, b.facets.alpha.y);
    vec2 e = albedoPair(b.albedoTable, abs(w.z), stretchedAlpha(b.facets, w), needsBothAlbedos());
    float sideways = stretch * (0.3 + 0.5 * most * most * (most - plane));
    return vec2(e.x + sideways * e.x * e.x * (1.0 - e.x), mix(e.y, 1.0, 0.4 * stretch));
}

// What of the light from w the interface keeps from the diffuse base, as 1 − that.
float throughAt(Bsdf b, vec3 w, vec2 albedos) {
    float through = couplingAt(b.compensation.coupling, albedos);
    // These curves have no table: at grazing angles they may reflect more than the bound that the tables give.
    if (hasFilm(b.face) || isSteep(b.face)) {
        float most = 0.0;
        uint angles = isSteep(b.face) ? 2u : 1u;
        for (uint i = 0u; i < angles; ++i) most = max(most, maxComponent(outerReflectance(b.face, i == 0u ? abs(w.z) : 1.0)));
        through = min(through, 1.0 - mix(b.compensation.again, most, albedos.y));
    }
    return clamp(through, 0.0, 1.0);
}

// What the facets give, judged by a smooth surface. A black metal, one of black specular colour or under a film may
// reflect nothing there and yet do so off tilted facets.
float facetWeight(Interface f, float cosTheta) {
    FacetShares shares = facetShares(f, cosTheta);
    float weight = max(luminance(shares.reflected) + shares.passes, 0.04 * f.metallic);
    if (has(FEATURE_SPECULAR_COLOR) && f.tinted) weight = max(weight, 0.04 * f.specular);
    if (hasFilm(f)) weight = max(weight, 0.04 * f.film);
    return weight;
}

// Probabilities in proportion to what each lobe gives. The front lobe is the rest, so that it is chosen
// with certainty where there is nothing else.
void setChances(inout Bsdf b, vec3 wo) {
    float coat = has(FEATURE_CLEARCOAT) && b.coat.weight > 0.0 ? coatAlbedo(b.coat, wo) : 0.0;
    float sheen = hasSheen() ? b.belowCoat * sheenAlbedo(b.sheen, wo) : 0.0;
    float front = luminance(b.diffuse.front), back = 0.0;
    if (has(FEATURE_DIFFUSE_TRANSMISSION)) back = luminance(b.diffuse.back);
    if (hasMultiple() && b.compensation.multiple.present) {
        front += luminance(b.compensation.multiple.frontAlbedo);
        back += luminance(b.compensation.multiple.backAlbedo);
    }
    float facets = has(FEATURE_SPECULAR) ? facetWeight(b.face, wo.z) : 0.0;
    front *= b.below;
    back *= b.below;
    facets *= b.below;
    float others = coat + sheen + back + facets;
    b.coatChance = b.sheenChance = b.backChance = b.facetChance = 0.0;
    b.frontChance = 1.0;
    if (others > 0.0) {
        float total = front + others;
        b.coatChance = coat / total;
        b.sheenChance = sheen / total;
        b.backChance = back / total;
        b.facetChance = facets / total;
        b.frontChance = front / total;
    }
}

Facets facetsAt(MaterialPoint m) {
    Facets f = Facets(vec2(m.alpha), m.flags);
    if (has(FEATURE_ANISOTROPY) && m.alphaT != m.alpha) {
        f.alpha.x = m.alphaT;
        // One axis alone cannot be a mirror.
        if (m.alphaT >= ALPHA_DELTA) f.alpha.y = max(f.alpha.y, ALPHA_DELTA);
        // Phong's facets are not stretched, nor may be what draws them.
        if (isPhong(f)) f.alpha = vec2(meanAlpha(f));
    }
    return f;
}

bool isMirror(Facets facets, Interface face) {
    if (!has(FEATURE_MIRROR)) return false;
    // An index of 1 deflects nothing, however rough.
    return max(facets.alpha.x, facets.alpha.y) < ALPHA_DELTA || transmits(face) && face.eta == 1.0 && !face.thin;
}

void setInterface(inout Bsdf b, vec3 wo, bool frontFace) {
    b.compensation.multiple.present = false;
    if (!has(FEATURE_SPECULAR) || b.albedoTable == NO_INDEX) return;
    vec2 albedos = albedosAt(b, wo);
    float average = b.alpha;
    if (has(FEATURE_ANISOTROPY) && !b.mirror) average *= 1.0 - 0.5 * stretchOf(b.facets);  // as stretchedAlpha
    vec2 averages = averageAlbedoPair(b.albedoTable, average);
    // The tables know one α: with two of them compensation would give up to 7 % too much along the grooves.
    bool uncompensated = b.mirror || isStretched(b.facets);
    b.compensation = compensationAt(b.face, b.albedoTable, frontFace, uncompensated, b.alpha, wo.z, albedos, averages);
    float throughAverage = couplingAt(b.compensation.coupling, averages);
    // Not less than where all is reflected, whatever the bounds of films and strong colours say.
    if (has(FEATURE_SPECULAR_COLOR) && b.face.tinted || hasFilm(b.face))
        throughAverage = max(throughAverage, (1.0 - averages.y) * (1.0 - b.compensation.again));
    // Below a twentieth the tables' error is most of it: the base then gets less than its share of next to nothing.
    float through = throughAt(b, wo, albedos) / max(throughAverage, 0.05);
    b.diffuse.front *= through;
    if (has(FEATURE_DIFFUSE_TRANSMISSION)) b.diffuse.back *= through;
}

// Coat and sheen, and what they let through.
void setLayers(inout Bsdf b, MaterialPoint m, vec3 wo) {
    b.belowCoat = 1.0;
    if (has(FEATURE_CLEARCOAT)) {
        b.coat = coatAt(m, wo);
        if (b.coat.weight > 0.0) b.belowCoat = 1.0 - coatAlbedo(b.coat, wo);
    }
    b.below = b.belowCoat;
    if (hasSheen()) {
        b.sheen = sheenAt(m, wo);
        b.below *= 1.0 - sheenAlbedo(b.sheen, wo);
    }
}

Bsdf bsdfAt(MaterialPoint m, vec3 wo, bool frontFace) {
    Bsdf b;
    b.face = interfaceAt(m, frontFace);
    b.facets = facetsAt(m);
    b.albedoTable = m.albedoTable;
    b.diffuse = diffuseBaseAt(m);
    b.mirror = isMirror(b.facets, b.face);
    b.alpha = b.mirror ? 0.0 : meanAlpha(b.facets);  // the tables know a mirror by it
    setLayers(b, m, wo);
    setInterface(b, wo, frontFace);
    setChances(b, wo);
    return b;
}

vec3 mirrored(vec3 w) { return vec3(w.xy, -w.z); }

// Rough reflection and transmission; adds to pdf what the facets' lobe has there. Thin-walled transmission is the mirror
// image of reflection.
vec3 facetsEval(Bsdf b, vec3 wo, vec3 wi, inout float pdf) {
    if (!(wi.z > 0.0) && !transmits(b.face)) return vec3(0);
    bool passes = has(FEATURE_TRANSMISSION) && !(wi.z > 0.0);
    bool refracts = passes && !b.face.thin;
    Refraction r;
    vec3 h;
    float cosTheta;
    if (refracts) {
        r = refractionAt(wo, wi, b.face.ior, b.face.inside);
        if (!r.possible) return vec3(0);
        h = r.h;
        cosTheta = r.cosO;
    } else {
        if (passes) wi = mirrored(wi);
        h = reflectionHalfVector(wo, wi, cosTheta);
    }
    FacetShares shares = facetShares(b.face, cosTheta);
    if (refracts && b.face.eta < 1.0) shares.passes = transmittanceOutwards(b.face, -r.cosI);
    float chance = reflectChance(b.face, shares);
    float d = facetD(b.facets, h), visibility = facetVisibility(b.facets, wo, wi);
    float value = refracts ? transmissionEval(r, d, visibility, wi, b.face.eta) : reflectionEval(d, visibility, wo, wi);
    float density = refracts ? transmissionPdf(b.facets, r, wo) : reflectionPdf(b.facets, h, wo, wi);
    pdf += b.facetChance * (passes ? 1.0 - chance : chance) * density;
    return passes ? b.face.baseColor * (shares.passes * value) : shares.reflected * value;
}

// The lobes that cosine lobes sample, on either side; `diffuse`: what the diffuse base has in it.
vec3 broadEval(Bsdf b, vec3 wo, vec3 wi, inout float pdf, out vec3 diffuse) {
    vec3 f = vec3(0);
    vec2 albedos = has(FEATURE_SPECULAR) ? albedosAt(b, wi) : vec2(0);
    bool lit = true;
    if (wi.z > 0.0) {
        f = diffuseFrontEval(b.diffuse, wo, wi);
        pdf = b.frontChance * cosinePdf(wi);
    } else if (hasBack() && b.backChance > 0.0) {
        if (has(FEATURE_DIFFUSE_TRANSMISSION)) f = diffuseBackEval(b.diffuse, wo, wi);
        pdf = b.backChance * cosinePdf(wi);
    } else {
        lit = false;
    }
    if (has(FEATURE_SPECULAR) && lit && b.albedoTable != NO_INDEX) {
        f *= throughAt(b, wi, albedos);
        diffuse = f;
        if (hasMultiple() && b.compensation.multiple.present)
            f += multipleEval(b.compensation.multiple, b.face, b.alpha, wi, albedos);
    } else {
        diffuse = f;
    }
    return f;
}

// All rough lobes at once; pdf as bsdfSample has it. `diffuse`: what the diffuse base has in it.
vec3 bsdfEvalParts(Bsdf b, vec3 wo, vec3 wi, out float pdf, out vec3 diffuse) {
    pdf = 0.0;
    vec3 f = broadEval(b, wo, wi, pdf, diffuse);
    if (has(FEATURE_SPECULAR) && !b.mirror && b.facetChance > 0.0) f += facetsEval(b, wo, wi, pdf);
    if (hasLayers()) {
        f *= b.below;
        diffuse *= b.below;
    }
    if (hasSheen() && b.sheenChance > 0.0 && wi.z > 0.0) {
        f += b.belowCoat * sheenEval(b.sheen, wo, wi);
        pdf += b.sheenChance * sheenPdf(b.sheen, wi);
    }
    if (has(FEATURE_CLEARCOAT) && b.coatChance > 0.0 && !coatIsMirror(b.coat)) {
        f += coatEval(b.coat, wo, wi);
        pdf += b.coatChance * coatPdf(b.coat, wo, wi);
    }
    return f;
}

vec3 bsdfEval(Bsdf b, vec3 wo, vec3 wi, out float pdf) {
    vec3 diffuse;
    return bsdfEvalParts(b, wo, wi, pdf, diffuse);
}

// Direction of the microfacet lobes given the sampled normal h; false where light cannot go.
bool sampleFacet(Bsdf b, vec3 wo, vec3 h, bool reflects, out vec3 wi) {
    wi = reflectionSample(wo, h);
    if (reflects) return wi.z > 0.0;
    if (!b.face.thin) return transmissionSample(wo, h, b.face.eta, wi);
    wi = mirrored(wi);
    return wi.z < 0.0;
}

// Not of NaN.
bool isDirection(vec3 w) { return all(lessThan(abs(w), vec3(2))); }

bool deltaSample(vec3 weight, inout BsdfSample s) {
    s.weight = weight;
    s.pdf = 0.0;
    s.delta = true;
    return true;
}

// `pick`: what is left of the number that chose the lobe; it decides between reflecting and transmitting.
// True: s is complete or, where it is not a delta, lacks weight and pdf.
bool sampleFacets(Bsdf b, vec3 wo, float pick, vec2 u, inout BsdfSample s) {
    vec3 h = b.mirror ? vec3(0, 0, 1) : facetSample(b.facets, wo, u);
    float cosTheta = dot(wo, h);
    // Distributions that do not know wo also give facets that it does not see.
    s.blocked = cosTheta <= 0.0;
    if (!(cosTheta > 0.0)) return false;
    FacetShares shares = facetShares(b.face, cosTheta);
    float chance = reflectChance(b.face, shares);
    // The chances' rounding must not choose what cannot be.
    bool reflects = chance > 0.0 && pick < chance * b.facetChance || chance >= 1.0;
    bool passes = sampleFacet(b, wo, h, reflects, s.wi);
    s.blocked = !passes && isDirection(s.wi);
    if (!passes) return false;
    if (!b.mirror) return true;
    vec3 colour = reflects ? shares.reflected : b.face.baseColor * shares.passes;
    if (!reflects && !b.face.thin) colour /= b.face.eta * b.face.eta;
    if (hasLayers()) colour *= b.below;
    return deltaSample(colour / (b.facetChance * (reflects ? chance : 1.0 - chance)), s);
}

// What goes straight on through smooth thin-walled glass, of light that leaves towards wo: the mean of the samples that
// sampleFacets draws through it. 0 of any other surface.
vec3 straightThrough(MaterialPoint m, vec3 wo, bool frontFace) {
    Bsdf b;
    b.face = interfaceAt(m, frontFace);
    if (!b.face.thin || !(wo.z > 0.0) || !isMirror(facetsAt(m), b.face)) return vec3(0);
    setLayers(b, m, wo);
    return b.face.baseColor * (b.below * facetShares(b.face, wo.z).passes);
}

// A sample that went this way.
bool isStraightThrough(Bsdf b, BsdfSample s) { return s.delta && s.wi.z < 0.0 && b.face.thin; }

// Draws wi; false for a sample that carries nothing. `u` chooses lobe and direction.
bool bsdfSample(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
    s.delta = s.blocked = false;
    float pick = u.x;
    if (has(FEATURE_CLEARCOAT)) {
        if (pick < b.coatChance) {
            vec3 colour;
            bool passes = coatSample(b.coat, wo, u.yz, s.wi, colour);
            s.blocked = !passes && isDirection(s.wi);
            if (!passes) return false;
            if (coatIsMirror(b.coat)) return deltaSample(colour / b.coatChance, s);
        }
        pick -= b.coatChance;
    }
    if (pick >= 0.0) {
        float sheen = hasSheen() ? b.sheenChance : 0.0;
        float cosine = sheen + b.frontChance;
        float back = hasBack() ? b.backChance : 0.0;
        float facets = has(FEATURE_SPECULAR) ? b.facetChance : 0.0;
        // Chances may sum to a little less than 1: what is left over belongs to the last lobe that has any.
        if (pick < cosine || !(back > 0.0) && !(facets > 0.0)) {
            s.wi = hasSheen() && pick < sheen ? sheenSample(b.sheen, u.yz) : cosineHemisphere(u.yz);
        } else if (hasBack() && (pick < cosine + back || !(facets > 0.0))) {
            s.wi = mirrored(cosineHemisphere(u.yz));
        } else if (has(FEATURE_SPECULAR)) {
            if (!sampleFacets(b, wo, pick - cosine - back, u.yz, s)) return false;
            if (s.delta) return true;
        }
    }
    vec3 f = bsdfEval(b, wo, s.wi, s.pdf);
    if (!(s.pdf > 0.0)) return false;
    s.weight = f / s.pdf;
    return true;
}

#endif
