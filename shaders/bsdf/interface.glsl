// The interface between air and base: what its microfacets reflect, and what they let through.
//
// Dielectrics: Fe(cosθ) is the exact Fresnel term or Schlick's, from the side that wo is on. With
// KHR_materials_specular,
//   F = specular · (F0' + (1 − F0') t),  t = (Fe − F0e) / (1 − F0e),  F0' = min(F0e · specularColor, 1)
//     = specular · (1 − κ (1 − Fe)),     κ = (1 − F0') / (1 − F0e),
// so that any curve keeps its shape; total internal reflection stays 1. What is not reflected passes, by
// the strongest channel, as the extension has it: 1 − max(F).
// Metals: Schlick's curve of the base colour, or the exact term of a measured η + i k.
// A thin film (thin_film.glsl) takes the place of both by the share `iridescence`.
#ifndef INTERFACE_GLSL
#define INTERFACE_GLSL

#include "fresnel.glsl"
#include "thin_film.glsl"

struct Interface {
    vec3 baseColor;      // of metals; tints what is transmitted
    float metallic;
    float eta;           // index of the far side over that of wo's side
    float ior;           // index behind the surface over that in front of it
    bool inside;         // wo is behind
    float transmission;  // share of the dielectric that transmits
    uint flags;
    bool thin;
    bool tinted;         // FEATURE_SPECULAR_COLOR and other than the plain curve
    bool ideal;          // an index of 0, which stands for F0e = 1: Schlick's curve from specularColor
    vec3 kappa;
    float specular;
    vec3 conductorEta, conductorK;
    float film, filmIor, filmThickness;  // share; nm
    vec3 filmBase;                       // dielectric reflectance under the film at normal incidence
};

Interface interfaceAt(MaterialPoint m, bool frontFace) {
    Interface f;
    f.baseColor = m.baseColor;
    f.metallic = m.metallic;
    f.transmission = m.transmission;
    f.flags = m.flags;
    f.thin = (m.flags & MATERIAL_THIN) != 0u;
    f.tinted = false;
    f.ideal = false;
    f.kappa = vec3(1);
    f.specular = 1.0;
    float ior = m.ior;
    if (has(FEATURE_SPECULAR_COLOR)) {
        f.ideal = m.ior == 0.0;
        f.tinted = f.ideal || m.specular != 1.0 || any(notEqual(m.specularColor, vec3(1)));
        if (f.ideal) ior = 1.5;  // for what is refracted
        if (f.tinted) {
            f.specular = m.specular;
            float f0 = f.ideal ? 0.0 : fresnelNormal(ior);
            f.kappa = (1.0 - min((f.ideal ? 1.0 : f0) * m.specularColor, 1.0)) / (1.0 - f0);
        }
    }
    f.inside = !(frontFace || f.thin || m.transmission == 0.0);
    f.ior = ior;
    f.eta = f.inside ? 1.0 / ior : ior;
    if (has(FEATURE_CONDUCTOR)) {
        f.conductorEta = m.conductorEta;
        f.conductorK = m.conductorK;
    }
    f.film = 0.0;
    if (has(FEATURE_IRIDESCENCE) && m.iridescence > 0.0 && m.iridescenceThickness > 0.0) {
        f.film = m.iridescence;
        f.filmIor = m.iridescenceIor;
        f.filmThickness = m.iridescenceThickness;
        f.filmBase = f.ideal ? min(m.specularColor, 1.0) * m.specular : vec3(fresnelNormal(ior));
        if (has(FEATURE_SPECULAR_COLOR) && !f.ideal) f.filmBase = min(f.filmBase * m.specularColor, 1.0) * m.specular;
    }
    return f;
}

float dielectricCurve(Interface f, float cosTheta, float eta) {
    if (has(FEATURE_SCHLICK) && (f.flags & MATERIAL_SCHLICK) != 0u) return fresnelDielectricSchlick(cosTheta, eta);
    return fresnelDielectric(cosTheta, eta);
}

// The cosine on the rarer side of an interface, of one on the side where the index beyond is eta; 0 beyond the critical
// angle.
float rarerCosine(float cosTheta, float eta) {
    if (eta >= 1.0) return cosTheta;
    return sqrt(max(0.0, 1.0 - (1.0 - cosTheta) * (1.0 + cosTheta) / (eta * eta)));
}

bool hasFilm(Interface f) { return has(FEATURE_IRIDESCENCE) && f.film > 0.0; }

vec3 bareDielectric(Interface f, float cosTheta, float eta) {
    if (has(FEATURE_SPECULAR_COLOR) && f.tinted) {
        float through = f.ideal ? 1.0 - schlickWeight(rarerCosine(cosTheta, eta)) : 1.0 - dielectricCurve(f, cosTheta, eta);
        return eta < 1.0 && !(through > 0.0) ? vec3(1) : f.specular * max(1.0 - f.kappa * through, 0.0);
    }
    return vec3(dielectricCurve(f, cosTheta, eta));
}

vec3 dielectricReflectance(Interface f, float cosTheta, float eta) {
    vec3 bare = bareDielectric(f, cosTheta, eta);
    if (!hasFilm(f)) return bare;
    // The film is outside: from inside light meets it at the refracted angle, and it reflects alike from either side.
    if (eta < 1.0) {
        cosTheta = rarerCosine(cosTheta, eta);
        if (cosTheta == 0.0) return vec3(1);
    }
    return mix(bare, filmReflectance(cosTheta, f.filmIor, f.filmThickness, f.filmBase), f.film);
}

vec3 bareMetal(Interface f, float cosTheta) {
    if (has(FEATURE_CONDUCTOR) && (f.flags & MATERIAL_CONDUCTOR) != 0u)
        return fresnelConductor(cosTheta, f.conductorEta, f.conductorK);
    return fresnelSchlick(f.baseColor, cosTheta);
}

vec3 metalReflectance(Interface f, float cosTheta) {
    vec3 bare = bareMetal(f, cosTheta);
    if (!hasFilm(f)) return bare;
    return mix(bare, filmReflectance(cosTheta, f.filmIor, f.filmThickness, bareMetal(f, 1.0)), f.film);
}

// A dark specular colour on a high index (from about 2.6 on): the curve falls to 0 over most angles and is cut off there,
// and κ magnifies the digits of the albedo tables, so that what is linear in them is no bound.
bool isSteep(Interface f) { return has(FEATURE_SPECULAR_COLOR) && f.tinted && maxComponent(f.kappa) > 1.25; }

// From outside, whichever side it is seen from.
vec3 outerReflectance(Interface f, float cosTheta) { return dielectricReflectance(f, cosTheta, f.eta < 1.0 ? 1.0 / f.eta : f.eta); }

// The dielectric as the diffuse base meets it, a bound on the strongest channel linear in the albedo tables:
// E = x · E1 − y · (E1 − Ed). A film counts with what it reflects at its brightest thickness, and 3 % more,
// as much as Schlick's curve in the film is above the exact one in the tables towards grazing angles.
vec2 dielectricScale(Interface f) {
    vec2 scale = vec2(1);
    if (has(FEATURE_SPECULAR_COLOR) && f.tinted) scale = f.specular * vec2(1.0, min(f.kappa.x, min(f.kappa.y, f.kappa.z)));
    if (hasFilm(f)) {
        float f0 = f.ideal ? 0.0 : fresnelNormal(f.eta);
        float kappa = (1.0 - maxComponent(filmEnvelope(f.filmIor, f.filmBase))) / (1.0 - f0);
        scale = mix(scale, vec2(1.03, kappa), f.film);
    }
    return scale;
}

// Share that passes a microfacet whose dielectric reflects so much; to be tinted by the base colour.
float transmittance(Interface f, vec3 dielectric) {
    return has(FEATURE_TRANSMISSION) ? (1.0 - f.metallic) * f.transmission * (1.0 - maxComponent(dielectric)) : 0.0;
}

// What a microfacet makes of light. Both shares come from one evaluation, which callers keep: drivers copy a function to
// each of its calls, and these curves are most of a kernel's code.
struct FacetShares {
    vec3 reflected;
    float passes;  // to be tinted by the base colour
};

FacetShares facetShares(Interface f, float cosTheta) {
    vec3 dielectric = dielectricReflectance(f, cosTheta, f.eta);
    float passes = transmittance(f, dielectric);
    // From inside a solid that transmits in part, only that part reflects totally.
    if (has(FEATURE_TRANSMISSION) && f.eta < 1.0 && f.transmission < 1.0)
        dielectric = mix(dielectricReflectance(f, cosTheta, 1.0 / f.eta), dielectric, f.transmission);
    return FacetShares(mix(dielectric, metalReflectance(f, cosTheta), f.metallic), passes);
}

bool transmits(Interface f) { return has(FEATURE_TRANSMISSION) && f.transmission > 0.0; }

// What passes of light that is refracted from the dense side, by its cosine beyond: that cannot be told from the one on
// the dense side to more than a few digits near the critical angle, and light that goes back would meet other ones.
float transmittanceOutwards(Interface f, float cosBeyond) {
    return transmittance(f, dielectricReflectance(f, cosBeyond, f.inside ? f.ior : 1.0 / f.ior));
}

// Probability of reflecting rather than transmitting at a microfacet.
float reflectChance(Interface f, FacetShares shares) {
    if (!has(FEATURE_TRANSMISSION)) return 1.0;
    float reflected = luminance(shares.reflected);
    float transmitted = shares.passes * max(maxComponent(f.baseColor), 1e-3);
    return transmitted > 0.0 ? reflected / (reflected + transmitted) : 1.0;
}

// Cosine-weighted averages over directions outside, 2 ∫ F cosθ dcosθ.
vec3 dielectricAverage(Interface f) {
    float eta = f.eta < 1.0 ? 1.0 / f.eta : f.eta;
    float curve = fresnelDielectricAverage(eta);
    if (has(FEATURE_SCHLICK) && (f.flags & MATERIAL_SCHLICK) != 0u) curve = mix(fresnelNormal(eta), 1.0, 1.0 / 21.0);
    vec3 average = vec3(curve);
    if (has(FEATURE_SPECULAR_COLOR) && f.tinted) {
        if (f.ideal) curve = 1.0 / 21.0;
        average = clamp(f.specular * (1.0 - f.kappa * (1.0 - curve)), 0.0, 1.0);
    }
    if (!hasFilm(f)) return average;
    return mix(average, filmReflectance(FRESNEL_AVERAGE_COSINE, f.filmIor, f.filmThickness, f.filmBase), f.film);
}
vec3 metalAverage(Interface f) { return clamp(metalReflectance(f, FRESNEL_AVERAGE_COSINE), 0.0, 1.0); }

#endif
