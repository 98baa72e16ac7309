// Queries that light_probe.comp answers; included by both sides.
#ifndef LIGHT_PROBE_H
#define LIGHT_PROBE_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace tilefarm {
using glm::uvec4;
using glm::vec4;
#define PROBE_CONSTANT inline constexpr uint32_t
#else
#define PROBE_CONSTANT const uint
#endif

PROBE_CONSTANT PROBE_SAMPLE = 0;  // draw a point of light `ask.y` with the random bits
PROBE_CONSTANT PROBE_PDF = 1;     // pdf with which that light would be found along `direction`; -1 where it is never chosen
PROBE_CONSTANT PROBE_TREE = 2;    // choose a light by the tree, and ask for its probability
PROBE_CONSTANT PROBE_PMF = 3;     // probability of light `ask.y` by the tree

struct LightQuery {
    vec4 position;
    vec4 normal;
    vec4 direction;
    uvec4 bits;
    uvec4 ask;  // PROBE_*, light, sample index
};

struct LightAnswer {
    vec4 wi;        // xyz, pdf
    vec4 radiance;  // rgb, 1 if there is a sample
    vec4 chosen;    // light as float bits, pmf sampled, pmf asked;
                    // PROBE_SAMPLE: distance; PROBE_PDF: distance of what is met, and 1 if it is that light
};

#ifdef __cplusplus
}  // namespace tilefarm
#endif
#undef PROBE_CONSTANT
#endif
