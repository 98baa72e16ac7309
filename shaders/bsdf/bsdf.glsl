// The material model: glTF metallic-roughness with transmission.
//
//   reflection    D G / (4 cos cos) · F,  F = mix(exact dielectric, Schlick of the base colour, metallic)
//   transmission  (1 − metallic) · transmission · baseColor · (1 − F), refracting or thin-walled
//   diffuse       (1 − metallic) (1 − transmission) · baseColor / π · (1 − E(wo)) (1 − E(wi)) / (1 − Eavg)
//
// The diffuse base gets what the rough interface above it lets through in both directions (Kelemen,
// Szirmay-Kalos 2001), which keeps it reciprocal and the sum from exceeding 1. Directions are in the
// shading frame with wo.z > 0. `eval` is BSDF times cosine.
#ifndef BSDF_GLSL
#define BSDF_GLSL

#include "fresnel.glsl"
#include "ggx.glsl"
#include "diffuse.glsl"
#include "reflection.glsl"
#include "transmission.glsl"
#include "albedo_table.glsl"

struct Bsdf {
    vec3 baseColor;
    float metallic;
    float alpha;
    float eta;             // index of the far side over that of wo's side
    float transmission;    // share of the dielectric that transmits
    vec3 diffuseAlbedo;    // without the factor of wi
    uint albedoTable;
    float diffuseChance;   // probability of sampling the diffuse lobe
    bool thin;
    bool mirror;           // reflection and transmission are delta lobes
};

struct BsdfSample {
    vec3 wi;
    vec3 weight;  // BSDF times cosine over pdf
    float pdf;    // solid angle, 1/sr; of all lobes together; not used for delta lobes
    bool delta;
};

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

Bsdf bsdfAt(MaterialPoint m, vec3 wo, bool frontFace) {
    Bsdf b;
    b.baseColor = m.baseColor;
    b.metallic = m.metallic;
    b.alpha = m.alpha;
    b.thin = (m.flags & MATERIAL_THIN) != 0u;
    b.eta = frontFace || b.thin || m.transmission == 0.0 ? m.ior : 1.0 / m.ior;
    b.transmission = m.transmission;
    b.albedoTable = m.albedoTable;
    b.diffuseAlbedo = m.baseColor * ((1.0 - m.metallic) * (1.0 - m.transmission));
    b.mirror = has(FEATURE_MIRROR) && m.alpha < ALPHA_DELTA;
    b.diffuseChance = 1.0;
    if (has(FEATURE_SPECULAR)) {
        float through = 1.0 - reflectionAlbedo(b.albedoTable, wo.z, b.alpha);
        b.diffuseAlbedo *= through / max(1.0 - averageReflectionAlbedo(b.albedoTable, b.alpha), 1e-4);
        float diffuse = luminance(b.diffuseAlbedo);
        float specular = luminance(fresnel(b, wo.z)) + transmittance(b, wo.z);
        b.diffuseChance = diffuse > 0.0 ? diffuse / (diffuse + specular) : 0.0;
    }
    return b;
}

// What the interface above the diffuse base lets through towards wi.
float diffuseFactor(Bsdf b, vec3 wi) {
    return has(FEATURE_SPECULAR) ? 1.0 - reflectionAlbedo(b.albedoTable, wi.z, b.alpha) : 1.0;
}

vec3 mirrored(vec3 w) { return vec3(w.xy, -w.z); }

bool transmits(Bsdf b) { return has(FEATURE_TRANSMISSION) && b.transmission > 0.0; }

// All rough lobes at once; pdf as bsdfSample has it.
vec3 bsdfEval(Bsdf b, vec3 wo, vec3 wi, out float pdf) {
    vec3 f = vec3(0);
    pdf = 0.0;
    bool reflects = wi.z > 0.0;
    if (reflects) {
        f = diffuseEval(b.diffuseAlbedo * diffuseFactor(b, wi), wo, wi);
        pdf = b.diffuseChance * diffusePdf(wo, wi);
    }
    if (!has(FEATURE_SPECULAR) || b.mirror) return f;
    if (reflects) {
        vec3 h = normalize(wo + wi);
        float cosTheta = dot(wo, h);
        f += fresnel(b, cosTheta) * reflectionEval(h, wo, wi, b.alpha);
        pdf += (1.0 - b.diffuseChance) * reflectChance(b, cosTheta) * reflectionPdf(h, wo, wi, b.alpha);
    } else if (transmits(b) && b.thin) {
        vec3 h = normalize(wo + mirrored(wi));
        float cosTheta = dot(wo, h);
        f += b.baseColor * transmittance(b, cosTheta) * reflectionEval(h, wo, mirrored(wi), b.alpha);
        pdf += (1.0 - b.diffuseChance) * (1.0 - reflectChance(b, cosTheta)) * reflectionPdf(h, wo, mirrored(wi), b.alpha);
    } else if (transmits(b)) {
        vec3 h = refractionHalfVector(wo, wi, b.eta);
        float cosTheta = dot(wo, h);
        f += b.baseColor * transmittance(b, cosTheta) * transmissionEval(h, wo, wi, b.alpha, b.eta);
        pdf += (1.0 - b.diffuseChance) * (1.0 - reflectChance(b, cosTheta)) * transmissionPdf(h, wo, wi, b.alpha, b.eta);
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

// Draws wi; false for a sample that carries nothing. `u` chooses lobe and direction.
bool bsdfSample(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
    s.delta = false;
    if (!has(FEATURE_SPECULAR) || u.x < b.diffuseChance) {
        s.wi = diffuseSample(wo, u.yz);
    } else {
        vec3 h = b.mirror ? vec3(0, 0, 1) : ggxSampleVisible(wo, b.alpha, u.yz);
        float cosTheta = dot(wo, h);
        float chance = reflectChance(b, cosTheta);
        // The rest of the lobe's random number is uniform again.
        bool reflects = (u.x - b.diffuseChance) < chance * (1.0 - b.diffuseChance);
        if (!sampleFacet(b, wo, h, reflects, s.wi)) return false;
        if (b.mirror) {
            vec3 colour = reflects ? fresnel(b, cosTheta) : b.baseColor * transmittance(b, cosTheta);
            if (!reflects && !b.thin) colour /= b.eta * b.eta;
            s.weight = colour / ((1.0 - b.diffuseChance) * (reflects ? chance : 1.0 - chance));
            s.pdf = 0.0;
            s.delta = true;
            return true;
        }
    }
    vec3 f = bsdfEval(b, wo, s.wi, s.pdf);
    if (!(s.pdf > 0.0)) return false;
    s.weight = f / s.pdf;
    return true;
}

#endif
