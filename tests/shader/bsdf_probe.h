// Queries that bsdf_probe.comp answers; included by both sides.
#ifndef BSDF_PROBE_H
#define BSDF_PROBE_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace tilefarm {
using glm::vec4;
#endif

// mode 0: draw wi with the numbers in `other`; 1: evaluate towards wi = `other`.
struct BsdfQuery {
    vec4 wo;       // xyz, front face
    vec4 color;    // base colour, metallic
    vec4 surface;  // α, ior, transmission, thin
    vec4 other;    // xyz, mode
};

struct BsdfAnswer {
    vec4 wi;     // xyz, pdf
    vec4 value;  // weight (mode 0) or BSDF times cosine (mode 1); w: 0 nothing, 1 sampled, 2 delta
};

#ifdef __cplusplus
}
#endif
#endif
