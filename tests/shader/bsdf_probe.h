// Queries that bsdf_probe.comp answers; included by both sides.
#ifndef BSDF_PROBE_H
#define BSDF_PROBE_H

#define PROBE_MATERIAL_TEXELS 11

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace tilefarm {
using glm::vec4;
#endif

struct BsdfQuery {
    vec4 wo;                               // xyz
    vec4 other;                            // w 0: xyz are the numbers to draw wi with; 1: the wi to evaluate towards
    vec4 material[PROBE_MATERIAL_TEXELS];  // ProbeMaterial of bsdf_probe_runner.h
};

struct BsdfAnswer {
    vec4 wi;     // xyz, pdf
    vec4 value;  // weight (drawn) or BSDF times cosine (evaluated); w: 0 nothing, 1 sampled, 2 delta
};

#ifdef __cplusplus
}
#endif
#endif
