#include "worker/render/shape_packer.h"

#include <algorithm>
#include <bit>
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
        default: return glm::dvec3(1);
    }
}

uint32_t kindOf(const Shape& shape) {
    switch (shape.kind) {
        case ShapeKind::sphere: return isSimilarity(shape.toWorld) ? gpu::SHAPE_SPHERE : gpu::SHAPE_ELLIPSOID;
        case ShapeKind::box: return gpu::SHAPE_BOX;
        case ShapeKind::rectangle: return gpu::SHAPE_RECTANGLE;
        case ShapeKind::disk: return gpu::SHAPE_DISK;
        case ShapeKind::cylinder: return gpu::SHAPE_CYLINDER;
        case ShapeKind::capsule: return gpu::SHAPE_CAPSULE;
        case ShapeKind::field: return gpu::SHAPE_FIELD;
    }
    return gpu::SHAPE_SPHERE;
}

static_assert(static_cast<uint32_t>(FieldOperation::mandelbulb) == gpu::FIELD_MANDELBULB);
static_assert(static_cast<uint32_t>(FieldOperation::subtract) == gpu::FIELD_DIFFERENCE);
static_assert(kMaxFieldStack == gpu::FIELD_STACK);

/// A capsule whose one sphere holds the other is that sphere; the kernel wants neither to.
Shape simplified(Shape shape) {
    if (shape.kind != ShapeKind::capsule || std::abs(shape.size.y - shape.size.z) < 2 * shape.size.x)
        return shape;
    const bool lower = shape.size.y > shape.size.z;
    shape.kind = ShapeKind::sphere;
    shape.toWorld[3] = shape.toWorld * glm::dvec4(0, lower ? -shape.size.x : shape.size.x, 0, 1);
    shape.size = glm::dvec3(lower ? shape.size.y : shape.size.z);
    return shape;
}

/// Moved so that the box around it is around the origin.
Shape centred(Shape shape) {
    const ShapeBounds own = boundsOf(shape.field);
    const glm::dvec3 centre = 0.5 * (own.lower + own.upper);
    for (FieldInstruction& instruction : shape.field) instruction.translation -= centre;
    shape.toWorld[3] = shape.toWorld * glm::dvec4(centre, 1);
    return shape;
}

void addInstruction(const FieldInstruction& instruction, std::vector<glm::uvec4>& texels) {
    const glm::vec4 p(instruction.parameters), turned(instruction.rotation);
    const glm::vec3 moved(instruction.translation);
    texels.emplace_back(static_cast<uint32_t>(instruction.operation), std::bit_cast<uint32_t>(p.x),
                        std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z));
    for (const glm::vec4& texel : {glm::vec4(moved, p.w), turned})
        texels.push_back(std::bit_cast<glm::uvec4>(texel));
}

/// A share of the estimated distance that a step of the march may take: smoothed or not, combinations are
/// nowhere steeper than 1; the fractal's estimate may be off by half.
float stepScale(const Shape& shape) {
    return std::any_of(shape.field.begin(), shape.field.end(),
                       [](auto& i) { return i.operation == FieldOperation::mandelbulb; })
               ? 0.5f
               : 1.0f;
}

gpu::ShapeRecord recordOf(const Shape& shape) {
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
    if (record.kind == gpu::SHAPE_CYLINDER || record.kind == gpu::SHAPE_CAPSULE) {
        const glm::vec3 size(shape.size);
        record.size0 = size.x, record.size1 = size.y, record.size2 = size.z;
    }
    return record;
}

void describeField(const Shape& shape, gpu::ShapeRecord& record, std::vector<glm::uvec4>& texels) {
    const ShapeBounds own = boundsOf(shape.field);
    record.extent = glm::vec3(0.5 * (own.upper - own.lower));
    record.program = static_cast<uint32_t>(texels.size());
    record.instructions = static_cast<uint32_t>(shape.field.size());
    record.size0 = stepScale(shape);
    record.size1 = static_cast<float>(glm::length(own.upper - own.lower));
    for (const FieldInstruction& instruction : shape.field) addInstruction(instruction, texels);
}

}  // namespace

std::vector<glm::uvec4> packShapes(const std::vector<WorldShape>& shapes) {
    std::vector<glm::uvec4> texels(shapes.size() * gpu::SHAPE_TEXELS);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const bool field = shapes[i].shape.kind == ShapeKind::field;
        const Shape shape = field ? centred(shapes[i].shape) : simplified(shapes[i].shape);
        gpu::ShapeRecord record = recordOf(shape);
        if (field) describeField(shape, record, texels);
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
