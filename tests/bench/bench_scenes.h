#pragma once

#include "worker/scene/scene.h"

namespace tilefarm::bench {

/// Makes every surface Lambert with its base colour: no metal, no specular layer (ior 1), no textures.
/// What the host path tracer of the benchmark can follow.
void makeLambert(Scene& scene);

/// A closed room, 4 x 3 x 4 metres, with a quad light under the ceiling and a displaced floor of
/// 2 * side * side triangles: incoherent rays over a large tree. With its own camera.
Scene terrainRoom(uint32_t side);

}  // namespace tilefarm::bench
