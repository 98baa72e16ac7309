// What the interface's single scattering leaves over: light that passes to the diffuse base, and light that
// microfacets shadow, which in truth scatters again.
//
// With E1 the albedo of the facets where they reflect everything and Ed that of the dielectric, both from
// tables, the dielectric's albedo with KHR_materials_specular is linear in them: specular · (E1 − κ (E1 − Ed)).
// What passes in direction μ is g(μ) = 1 − that − Fms (1 − E1), and the base is scaled by
// g(wo) g(wi) / gavg: reciprocal, and nothing is counted twice.
//
// Multiple scattering (Kulla, Conty 2017): (1 − E(wo)) (1 − E(wi)) / (π (1 − Eavg)) restores what is missing;
// reflection off metal and dielectric times Fms = Favg² E1avg / (1 − Favg (1 − E1avg)) for what each
// bounce absorbs or lets down. Solid glass misses x = 1 − E of reflection and transmission together, on
// either side its own: a share b of x is sent across,
//   b_near = T_near min(xavg_near, xavg_far) / xavg_near,  T_far / T_near = (n_near / n_far)²,
// which makes the lobe across reciprocal, x_near(wo) x_far(wi) / xavg_far, and the rest returned.
// FEATURE_ENERGY_COMPENSATION; sampled by cosine lobes on both sides.
#ifndef COMPENSATION_GLSL
#define COMPENSATION_GLSL

#include "albedo_table.glsl"

// Light that scatters more than once, as factors of what depends on wi.
struct MultipleScattering {
    vec3 front;       // times (1 − E1(wi)) cosθi
    vec3 glassFront;  // times x_near(wi) cosθi
    vec3 back;        // times x_far(wi) cosθi; thin-walled: (1 − E1(wi)) cosθi
    vec3 frontAlbedo, backAlbedo;  // for wo
    uint nearTable, farTable;
    bool present;
};

struct Compensation {
    vec3 coupling;  // g(μ) = x + y E1(μ) + z Ed(μ)
    float again;    // Fms of the dielectric's strongest channel
    MultipleScattering multiple;
};

// Both numbers of the pairs (Ed, E1) are asked for.
#define needsBothAlbedos() \
    ((featureBit(FEATURE_SPECULAR_COLOR) | featureBit(FEATURE_IRIDESCENCE) | featureBit(FEATURE_ENERGY_COMPENSATION)) != 0u)

#define needsClearAlbedo() ((featureBit(FEATURE_SPECULAR_COLOR) | featureBit(FEATURE_IRIDESCENCE)) != 0u)

float couplingAt(vec3 coupling, vec2 albedos) {
    if (!needsBothAlbedos()) return 1.0 - albedos.x;
    return coupling.x + coupling.y * albedos.y + coupling.z * albedos.x;
}

vec3 multipleBounces(vec3 f, float e) { return f * f * e / (1.0 - f * (1.0 - e)); }

// x: what solid glass misses, of the table pair (E of reflection and transmission, E where all is refracted). Films and
// steep curves have no table: they miss at least what those that reflect all or nothing both do.
float glassMissing(Interface f, vec2 glass, float e1) {
    if (!(has(FEATURE_SPECULAR_COLOR) && f.tinted) && !hasFilm(f)) return 1.0 - glass.x;
    if (isSteep(f) || hasFilm(f)) return 1.0 - max(glass.y, e1);
    vec2 scale = dielectricScale(f);
    return max(1.0 - mix(glass.y, e1, scale.x) - scale.y * (glass.x - e1), 0.0);
}

bool hasGlassScattering(Interface f) { return has(FEATURE_TRANSMISSION) && f.transmission > 0.0 && f.metallic < 1.0; }

// `albedos`, `averages`: (Ed, E1) for wo and on average.
Compensation compensationAt(Interface f, uint table, bool frontFace, bool mirror, float alpha, float cosTheta, vec2 albedos, vec2 averages) {
    Compensation c;
    c.multiple.present = false;
    c.coupling = vec3(1, 0, -1);
    c.again = 0.0;
    if (has(FEATURE_SPECULAR_COLOR) && f.tinted || hasFilm(f)) {
        vec2 scale = dielectricScale(f);
        c.coupling = vec3(1.0, scale.y - scale.x, -scale.y);
    }
    // Where next to nothing is missing there is nothing to restore but the tables' rounding.
    float x = 1.0 - albedos.y, xAverage = 1.0 - averages.y;
    if (!has(FEATURE_ENERGY_COMPENSATION) || mirror || !(xAverage > 1e-4)) return c;

    MultipleScattering m;
    m.present = true;
    m.glassFront = m.back = m.backAlbedo = vec3(0);
    m.nearTable = m.farTable = table;
    vec3 average = dielectricAverage(f);
    float strongest = maxComponent(average);
    vec3 dielectric = multipleBounces(average, averages.y);
    c.again = multipleBounces(vec3(strongest), averages.y).x;
    c.coupling += c.again * vec3(-1, 1, 0);
    float glass = has(FEATURE_TRANSMISSION) ? f.transmission : 0.0;
    m.frontAlbedo = mix((1.0 - glass) * dielectric, multipleBounces(metalAverage(f), averages.y), f.metallic) * x;
    glass *= 1.0 - f.metallic;
    if (hasGlassScattering(f) && f.thin) {
        m.frontAlbedo += glass * average * x;
        m.backAlbedo = glass * (1.0 - strongest) * f.baseColor * x;
        m.back = m.backAlbedo * (INV_PI / xAverage);
    }
    m.front = m.frontAlbedo * (INV_PI / xAverage);
    if (hasGlassScattering(f) && !f.thin) {
        m.nearTable = table + (frontFace ? 1u : 2u);
        m.farTable = table + (frontFace ? 2u : 1u);
        bool both = needsClearAlbedo();
        float xNear = glassMissing(f, albedoPair(m.nearTable, cosTheta, alpha, both), albedos.y);
        float near = glassMissing(f, averageAlbedoPair(m.nearTable, alpha), averages.y);
        float far = glassMissing(f, averageAlbedoPair(m.farTable, alpha), averages.y);
        if (xNear > 0.0 && min(near, far) > 1e-4) {
            float eta2 = f.eta * f.eta;
            float across = (1.0 - strongest) * (frontFace ? 1.0 : eta2) * min(near, far) / near;
            m.glassFront = vec3(glass * (1.0 - across) * xNear * INV_PI / near);
            m.frontAlbedo += glass * (1.0 - across) * xNear;
            m.backAlbedo = f.baseColor * (glass * across * xNear / eta2);
            m.back = m.backAlbedo * (INV_PI / far);
        }
    }
    c.multiple = m;
    return c;
}

// BSDF times cosine, 1/sr. `albedos`: (Ed, E1) for wi.
vec3 multipleEval(MultipleScattering m, Interface f, float alpha, vec3 wi, vec2 albedos) {
    float cosine = abs(wi.z);
    bool glassTable = hasGlassScattering(f) && !f.thin;
    float missing = 1.0 - albedos.y;
    bool both = needsClearAlbedo();
    if (wi.z > 0.0) {
        vec3 sum = m.front * missing;
        if (glassTable) sum += m.glassFront * max(glassMissing(f, albedoPair(m.nearTable, cosine, alpha, both), albedos.y), 0.0);
        return sum * cosine;
    }
    if (glassTable) missing = max(glassMissing(f, albedoPair(m.farTable, cosine, alpha, both), albedos.y), 0.0);
    return m.back * (missing * cosine);
}

#endif
