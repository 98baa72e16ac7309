#include "worker/scene/shape_reader.h"

#include <fmt/format.h>

#include "worker/scene/field_reader.h"
#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

constexpr const char* kImplicit = "KHR_implicit_shapes";
constexpr const char* kVendor = "TILEFARM_shapes";
constexpr double kEndless = 1000;  // half side of the square that stands for an endless plane, m

/// Half the height and the radii of a cylinder or capsule.
glm::dvec3 roundSize(const JsonNode& node, bool mayHaveTip) {
    const auto radius = [&](const char* name) {
        const JsonNode value = node[name];
        return mayHaveTip && value && value.number() == 0 ? 0.0 : positiveOr(value, 0.25);
    };
    const glm::dvec3 size(positiveOr(node["height"], 0.5) / 2, radius("radiusBottom"), radius("radiusTop"));
    if (!(size.y + size.z > 0)) node.fail("has no radius above 0");
    return size;
}

glm::dvec3 boxSize(const JsonNode& node) {
    if (!node["size"]) return glm::dvec3(0.5);
    const std::vector<double> size = node["size"].numbers(3);
    for (const double side : size)
        if (!(side > 0 && side <= 1e9)) node["size"].fail("must be above 0 and at most 1e9");
    return 0.5 * glm::dvec3(size[0], size[1], size[2]);
}

}  // namespace

ShapeReader::ShapeReader(LoadContext& load) : load_(load) {
    const JsonNode extensions = load.file.root()["extensions"];
    const JsonNode implicit = extensions[kImplicit]["shapes"], surfaces = extensions[kVendor]["surfaces"];
    for (size_t i = 0; i < implicit.size(); ++i)
        implicit_.add(implicit[i], [&] { return implicitShape(implicit[i]); });
    for (size_t i = 0; i < surfaces.size(); ++i)
        surfaces_.add(surfaces[i], [&] { return surface(surfaces[i]); });
}

ShapeReader::Declared ShapeReader::implicitShape(const JsonNode& node) {
    Declared result;
    Shape& shape = result.shape;
    const std::string& type = node["type"].text();
    const JsonNode parameters = node[type];
    if (type == "sphere") {
        shape.size = glm::dvec3(positiveOr(parameters["radius"], 0.5));
    } else if (type == "box") {
        shape.kind = ShapeKind::box;
        shape.size = boxSize(parameters);
    } else if (type == "cylinder" || type == "capsule") {
        shape.kind = type == "cylinder" ? ShapeKind::cylinder : ShapeKind::capsule;
        shape.size = roundSize(parameters, shape.kind == ShapeKind::cylinder);
    } else if (type == "plane") {
        shape.kind = ShapeKind::rectangle;
        result.endless = !parameters["sizeX"] || !parameters["sizeZ"];
        shape.size = {positiveOr(parameters["sizeX"], 2 * kEndless) / 2,
                      positiveOr(parameters["sizeZ"], 2 * kEndless) / 2, 0};
        shape.toWorld = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};  // its front towards +y
    } else {
        node["type"].fail("must be sphere, box, cylinder, capsule or plane");
    }
    return result;
}

ShapeReader::Declared ShapeReader::surface(const JsonNode& node) {
    Declared result;
    Shape& shape = result.shape;
    if (const JsonNode rectangle = node["rectangle"]) {
        shape.kind = ShapeKind::rectangle;
        const std::vector<double> size =
            rectangle["size"] ? rectangle["size"].numbers(2) : std::vector{1.0, 1.0};
        shape.size = {size[0] / 2, size[1] / 2, 0};
        if (!(size[0] > 0 && size[1] > 0)) rectangle.fail("has a side that is not above 0");
    } else if (const JsonNode disk = node["disk"]) {
        shape.kind = ShapeKind::disk;
        shape.size = glm::dvec3(positiveOr(disk["radius"], 0.5));
    } else if (const JsonNode field = node["field"]) {
        shape.kind = ShapeKind::field;
        shape.field = readField(field);
        const ShapeBounds bounds = boundsOf(shape.field);
        const glm::dvec3 sides = bounds.upper - bounds.lower;
        if (!(sides.x > 0 && sides.y > 0 && sides.z > 0)) field.fail("is empty: its parts do not meet");
    } else {
        node.fail("must have one of rectangle, disk, field");
    }
    return result;
}

std::optional<Shape> ShapeReader::shapeOf(const JsonNode& node, const glm::dmat4& toWorld) const {
    const JsonNode shown = node["extensions"][kVendor];
    if (!shown) return std::nullopt;
    const JsonNode implicit = shown["shape"], surface = shown["surface"];
    if (bool(implicit) == bool(surface)) shown.fail("must have either shape or surface");
    const Declared& declared =
        implicit ? implicit_[implicit.index(implicit_.size(), "/extensions/KHR_implicit_shapes/shapes")]
                 : surfaces_[surface.index(surfaces_.size(), "/extensions/TILEFARM_shapes/surfaces")];
    Shape shape = declared.shape;
    shape.toWorld = toWorld * shape.toWorld;
    const size_t materials = load_.file.root()["materials"].size();
    const JsonNode material = shown["material"];
    shape.material = material ? material.index(materials, "/materials")
                              : static_cast<uint32_t>(load_.scene.materials.size() - 1);
    warnOf(shape, declared.endless, node);
    return shape;
}

void ShapeReader::warnOf(const Shape& shape, bool endless, const JsonNode& node) const {
    if (endless) load_.warn(kImplicit, node, fmt::format("endless plane: a square of {} m", 2 * kEndless));
    if (!isProper(shape)) load_.warn(kVendor, node, "left out: its transform collapses it");
    const Material& material = load_.scene.materials[shape.material];
    if (isFlat(shape.kind) && isSolid(material))
        load_.warn(
            "KHR_materials_volume", node,
            fmt::format(
                "a {} has no inside: thin-walled, which refracts nothing and absorbs as one thickness does",
                nameOf(shape.kind)));
    // What light_packer.cpp makes a light of.
    const bool even =
        !material.emissionTexture && material.clearcoat == 0 && material.alphaMode == AlphaMode::opaque;
    const bool round = shape.kind == ShapeKind::sphere && isSimilarity(shape.toWorld) && material.doubleSided;
    const bool sampled = even && (shape.kind == ShapeKind::rectangle || round);
    if (material.emission != glm::vec3(0) && !sampled)
        load_.warn(
            kVendor, node,
            fmt::format("emissive {}: not sampled as a light, so its light is noisier", nameOf(shape.kind)));
}

}  // namespace tilefarm
