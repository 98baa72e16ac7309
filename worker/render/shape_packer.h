#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "worker/bvh/bvh.h"
#include "worker/scene/world.h"

namespace tilefarm {

/// ShapeRecords of gpu_types.h as texels, for shaders/shapes/shape.glsl. In the order of `shapes`.
std::vector<glm::uvec4> packShapes(const std::vector<WorldShape>& shapes);

/// Boxes around the shapes, in their order, for the BVH.
std::vector<BvhBox> shapeBoxes(const std::vector<WorldShape>& shapes);

}  // namespace tilefarm
