#include "worker/render/shape_packer.h"

#include <cmath>
#include <cstring>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

/// What the shape's own space of gpu_types.h is scaled by: sizes that a matrix can take go into it.
glm::dvec3 unitOf(const Shape& shape) {
    switch (shape.kind) {
        case ShapeKind::sphere: return glm::dvec3(shape.size.x);
        case ShapeKind::box: return shape.size;
        case ShapeKind::rectangle: return {shape.size.x, shape.size.y, std::min(shape.size.x, shape.size.y)};
        case ShapeKind::disk: return glm::dvec3(shape.size.x);
    }
    return glm::dvec3(1);
}

uint32_t kindOf(const Shape& shape) {
    switch (shape.kind) {
        case ShapeKind::sphere: return isSimilarity(shape.toWorld) ? gpu::SHAPE_SPHERE : gpu::SHAPE_ELLIPSOID;
        case ShapeKind::box: return gpu::SHAPE_BOX;
        case ShapeKind::rectangle: return gpu::SHAPE_RECTANGLE;
        case ShapeKind::disk: return gpu::SHAPE_DISK;
    }
    return gpu::SHAPE_SPHERE;
}

gpu::ShapeRecord recordOf(const WorldShape& world) {
    const Shape& shape = world.shape;
    const glm::dmat3 linear(shape.toWorld);
    const glm::dvec3 unit = unitOf(shape);
    const glm::dmat3 toWorld(linear[0] * unit.x, linear[1] * unit.y, linear[2] * unit.z);
    const glm::mat3 rows(glm::transpose(toWorld)), inverseRows(glm::transpose(glm::inverse(toWorld)));
    gpu::ShapeRecord record{};
    record.kind = kindOf(shape);
    record.material = shape.material;
    record.flags = glm::determinant(linear) < 0 ? gpu::SHAPE_MIRRORED : 0;
    record.toShape0 = inverseRows[0], record.toShape1 = inverseRows[1], record.toShape2 = inverseRows[2];
    record.toWorld0 = rows[0], record.toWorld1 = rows[1], record.toWorld2 = rows[2];
    const glm::vec3 centre(glm::dvec3(shape.toWorld[3]));
    record.centreX = centre.x, record.centreY = centre.y, record.centreZ = centre.z;
    if (record.kind == gpu::SHAPE_SPHERE)
        record.size0 = static_cast<float>(std::cbrt(std::abs(glm::determinant(toWorld))));
    return record;
}

}  // namespace

std::vector<glm::uvec4> packShapes(const std::vector<WorldShape>& shapes) {
    std::vector<glm::uvec4> texels(shapes.size() * gpu::SHAPE_TEXELS);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const gpu::ShapeRecord record = recordOf(shapes[i]);
        std::memcpy(&texels[i * gpu::SHAPE_TEXELS], &record, sizeof record);
    }
    return texels;
}

std::vector<BvhBox> shapeBoxes(const std::vector<WorldShape>& shapes) {
    std::vector<BvhBox> boxes;
    boxes.reserve(shapes.size());
    for (const WorldShape& shape : shapes) boxes.push_back({shape.lower, shape.upper});
    return boxes;
}

}  // namespace tilefarm
