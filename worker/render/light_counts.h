#pragma once

#include <cstdint>

namespace tilefarm {

/// How many lights a scene has, for reports: those that send out something, the environment aside.
struct LightCounts {
    uint64_t lights = 0;             // lamps, area lights, groups of emissive triangles, emissive shapes
    uint64_t emissiveGroups = 0;     // of triangles: one for the emissive ones of a mesh at a node
    uint64_t emissiveTriangles = 0;  // in these groups
};

}  // namespace tilefarm
