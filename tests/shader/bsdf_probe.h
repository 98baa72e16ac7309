// Queries that bsdf_probe.comp answers; included by both sides.
#ifndef BSDF_PROBE_H
#define BSDF_PROBE_H

#define PROBE_MATERIAL_TEXELS 11

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace tilefarm {
using glm::vec4;
#define PROBE_CONSTANT inline constexpr float
#else
#define PROBE_CONSTANT const float
#endif

// What BsdfQuery::other.w asks for.
PROBE_CONSTANT PROBE_DRAW = 0.0;     // wi, by the numbers other.xyz
PROBE_CONSTANT PROBE_EVAL = 1.0;     // BSDF and pdf towards other.xyz
PROBE_CONSTANT PROBE_PARTS = 2.0;    // the same, the diffuse base's part in wi.xyz
PROBE_CONSTANT PROBE_FURNACE = 3.0;  // other.x samples from start other.y: wi.xyz mean energy, wi.w how many of them are
                                     // not finite or negative, value.w share that goes anywhere

struct BsdfQuery {
    vec4 wo;                               // xyz
    vec4 other;                            // w: PROBE_*
    vec4 material[PROBE_MATERIAL_TEXELS];  // ProbeMaterial of bsdf_probe_runner.h
};

struct BsdfAnswer {
    vec4 wi;     // xyz, pdf
    vec4 value;  // weight (drawn) or BSDF times cosine (evaluated); w: 0 nothing, 1 sampled, 2 delta
};

#ifdef __cplusplus
}
#endif
#undef PROBE_CONSTANT
#endif
