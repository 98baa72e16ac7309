// The material model as a sum of lobes, from the top of the stack down:
//
//   coat          clearcoat · microfacets (clearcoat.glsl)
//   sheen         sheenColor · cloth (sheen.glsl)
//   interface     reflection and transmission of the microfacets between air and base, and what scatters
//                 more than once between them
//   diffuse base  front and back (diffuse.glsl)
//
// Interface: F = mix(dielectric, metal, metallic) is reflected; of the rest, the dielectric's share
// `transmission` passes, tinted by the base colour, refracted or thin-walled. The diffuse base gets what the
// rough interface above it lets through in both directions, (1 − E(wo)) (1 − E(wi)) / (1 − Eavg) (Kelemen,
// Szirmay-Kalos 2001), which keeps it reciprocal and the sum from exceeding 1.
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

#include "fresnel.glsl"
#include "ggx.glsl"
#include "diffuse.glsl"
#include "reflection.glsl"
#include "transmission.glsl"
#include "albedo_table.glsl"
#include "clearcoat.glsl"
#include "sheen.glsl"

struct Bsdf {
    vec3 baseColor;
    float metallic;
    float alpha;
    float eta;             // index of the far side over that of wo's side
    float transmission;    // share of the dielectric that transmits
    uint albedoTable;
    bool thin;
    bool mirror;           // reflection and transmission are delta lobes
    DiffuseBase diffuse;   // with the interface's and layers' factor of wo
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
};

bool hasLayers() { return has(FEATURE_CLEARCOAT) || has(FEATURE_SHEEN) || has(FEATURE_DISNEY_SHEEN); }
bool hasSheen() { return has(FEATURE_SHEEN) || has(FEATURE_DISNEY_SHEEN); }

vec3 fresnel(Bsdf b, float cosTheta) {
    return mix(vec3(fresnelDielectric(cosTheta, b.eta)), fresnelSchlick(b.baseColor, cosTheta), b.metallic);
}

float transmittance(Bsdf b, float cosTheta) {
    return has(FEATURE_TRANSMISSION) ? (1.0 - b.metallic) * b.transmission * (1.0 - fresnelDielectric(cosTheta, b.eta)) : 0.0;
}

// Probability of reflecting rather than transmitting at a microfacet.
float reflectChance(Bsdf b, float cosTheta) {
    if (!has(FEATURE_TRANSMISSION)) return 1.0;
    float reflected = luminance(fresnel(b, cosTheta));
    float transmitted = transmittance(b, cosTheta) * max(maxComponent(b.baseColor), 1e-3);
    return transmitted > 0.0 ? reflected / (reflected + transmitted) : 1.0;
}

// The interface's directional albedo.
float interfaceAlbedo(Bsdf b, float cosTheta) {
    return b.albedoTable == NO_INDEX ? 0.0 : reflectionAlbedo(b.albedoTable, cosTheta, b.alpha);
}

// Probabilities in proportion to what each lobe gives. The front lobe is the rest, so that it is chosen
// with certainty where there is nothing else.
void setChances(inout Bsdf b, vec3 wo) {
    float coat = has(FEATURE_CLEARCOAT) && b.coat.weight > 0.0 ? coatAlbedo(b.coat, wo) : 0.0;
    float sheen = hasSheen() ? b.belowCoat * sheenAlbedo(b.sheen, wo) : 0.0;
    float back = has(FEATURE_DIFFUSE_TRANSMISSION) ? b.below * luminance(b.diffuse.back) : 0.0;
    float facets = has(FEATURE_SPECULAR) ? b.below * (luminance(fresnel(b, wo.z)) + transmittance(b, wo.z)) : 0.0;
    float others = coat + sheen + back + facets;
    float front = b.below * luminance(b.diffuse.front);
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

Bsdf bsdfAt(MaterialPoint m, vec3 wo, bool frontFace) {
    Bsdf b;
    b.baseColor = m.baseColor;
    b.metallic = m.metallic;
    b.alpha = m.alpha;
    b.thin = (m.flags & MATERIAL_THIN) != 0u;
    b.eta = frontFace || b.thin || m.transmission == 0.0 ? m.ior : 1.0 / m.ior;
    b.transmission = m.transmission;
    b.albedoTable = m.albedoTable;
    b.diffuse = diffuseBaseAt(m);
    b.mirror = has(FEATURE_MIRROR) && m.alpha < ALPHA_DELTA;
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
    if (has(FEATURE_SPECULAR) && b.albedoTable != NO_INDEX) {
        float through = 1.0 - interfaceAlbedo(b, wo.z);
        through /= max(1.0 - averageReflectionAlbedo(b.albedoTable, b.alpha), 1e-4);
        b.diffuse.front *= through;
        if (has(FEATURE_DIFFUSE_TRANSMISSION)) b.diffuse.back *= through;
    }
    setChances(b, wo);
    return b;
}

vec3 mirrored(vec3 w) { return vec3(w.xy, -w.z); }

bool transmits(Bsdf b) { return has(FEATURE_TRANSMISSION) && b.transmission > 0.0; }

// Rough reflection and transmission; adds to pdf what the facets' lobe has there.
vec3 facetsEval(Bsdf b, vec3 wo, vec3 wi, inout float pdf) {
    if (wi.z > 0.0) {
        vec3 h = normalize(wo + wi);
        float cosTheta = dot(wo, h);
        pdf += b.facetChance * reflectChance(b, cosTheta) * reflectionPdf(h, wo, wi, b.alpha);
        return fresnel(b, cosTheta) * reflectionEval(h, wo, wi, b.alpha);
    }
    if (!transmits(b)) return vec3(0);
    vec3 h = b.thin ? normalize(wo + mirrored(wi)) : refractionHalfVector(wo, wi, b.eta);
    float cosTheta = dot(wo, h);
    float chance = b.facetChance * (1.0 - reflectChance(b, cosTheta));
    vec3 colour = b.baseColor * transmittance(b, cosTheta);
    if (b.thin) {
        pdf += chance * reflectionPdf(h, wo, mirrored(wi), b.alpha);
        return colour * reflectionEval(h, wo, mirrored(wi), b.alpha);
    }
    pdf += chance * transmissionPdf(h, wo, wi, b.alpha, b.eta);
    return colour * transmissionEval(h, wo, wi, b.alpha, b.eta);
}

// All rough lobes at once; pdf as bsdfSample has it.
vec3 bsdfEval(Bsdf b, vec3 wo, vec3 wi, out float pdf) {
    vec3 f = vec3(0);
    pdf = 0.0;
    if (wi.z > 0.0) {
        f = diffuseFrontEval(b.diffuse, wo, wi);
        pdf = b.frontChance * cosinePdf(wi);
        if (has(FEATURE_SPECULAR)) f *= 1.0 - interfaceAlbedo(b, wi.z);
    } else if (has(FEATURE_DIFFUSE_TRANSMISSION) && b.backChance > 0.0) {
        f = diffuseBackEval(b.diffuse, wo, wi);
        pdf = b.backChance * cosinePdf(wi);
        if (has(FEATURE_SPECULAR)) f *= 1.0 - interfaceAlbedo(b, -wi.z);
    }
    if (has(FEATURE_SPECULAR) && !b.mirror && b.facetChance > 0.0) f += facetsEval(b, wo, wi, pdf);
    if (hasLayers()) f *= b.below;
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

// Direction of the microfacet lobes given the sampled normal h; false where light cannot go.
bool sampleFacet(Bsdf b, vec3 wo, vec3 h, bool reflects, out vec3 wi) {
    wi = reflectionSample(wo, h);
    if (reflects) return wi.z > 0.0;
    if (!b.thin) return transmissionSample(wo, h, b.eta, wi);
    wi = mirrored(wi);
    return wi.z < 0.0;
}

bool deltaSample(vec3 weight, inout BsdfSample s) {
    s.weight = weight;
    s.pdf = 0.0;
    s.delta = true;
    return true;
}

// `pick`: what is left of the number that chose the lobe; it decides between reflecting and transmitting.
// True: s is complete or, where it is not a delta, lacks weight and pdf.
bool sampleFacets(Bsdf b, vec3 wo, float pick, vec2 u, inout BsdfSample s) {
    vec3 h = b.mirror ? vec3(0, 0, 1) : ggxSampleVisible(wo, b.alpha, u);
    float cosTheta = dot(wo, h);
    float chance = reflectChance(b, cosTheta);
    bool reflects = pick < chance * b.facetChance;
    if (!sampleFacet(b, wo, h, reflects, s.wi)) return false;
    if (!b.mirror) return true;
    vec3 colour = reflects ? fresnel(b, cosTheta) : b.baseColor * transmittance(b, cosTheta);
    if (!reflects && !b.thin) colour /= b.eta * b.eta;
    if (hasLayers()) colour *= b.below;
    return deltaSample(colour / (b.facetChance * (reflects ? chance : 1.0 - chance)), s);
}

// Draws wi; false for a sample that carries nothing. `u` chooses lobe and direction.
bool bsdfSample(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
    s.delta = false;
    float pick = u.x;
    if (has(FEATURE_CLEARCOAT)) {
        if (pick < b.coatChance) {
            vec3 colour;
            if (!coatSample(b.coat, wo, u.yz, s.wi, colour)) return false;
            if (coatIsMirror(b.coat)) return deltaSample(colour / b.coatChance, s);
        }
        pick -= b.coatChance;
    }
    if (pick >= 0.0) {
        float sheen = hasSheen() ? b.sheenChance : 0.0;
        float cosine = sheen + b.frontChance;
        float back = has(FEATURE_DIFFUSE_TRANSMISSION) ? b.backChance : 0.0;
        if (!has(FEATURE_SPECULAR) && !has(FEATURE_DIFFUSE_TRANSMISSION) || pick < cosine) {
            s.wi = hasSheen() && pick < sheen ? sheenSample(b.sheen, u.yz) : cosineHemisphere(u.yz);
        } else if (has(FEATURE_DIFFUSE_TRANSMISSION) && (!has(FEATURE_SPECULAR) || pick < cosine + back)) {
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
