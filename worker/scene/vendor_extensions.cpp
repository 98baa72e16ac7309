#include "worker/scene/vendor_extensions.h"

#include <numbers>

#include "shared/job/lighting_fields.h"
#include "shared/job/rules.h"
#include "worker/scene/material_override.h"

namespace tilefarm {

namespace {

struct VendorMaterial : MaterialOverride {};

struct VendorLight {
    std::optional<double> radius, width, height, angularDiameter;
    bool twoSided = false;
};

template <typename Visitor>
void describe(Visitor& v, Is<VendorMaterial> auto& material) {
    describeAppearance(v, material);
}

template <typename Visitor>
void describe(Visitor& v, Is<VendorLight> auto& light) {
    v.number({"radius", "makes the light a sphere of this radius, m"}, light.radius, kSize);
    v.number({"width", "makes the light a rectangle of this width, m"}, light.width, kSize);
    v.number({"height", "height of the rectangle, m"}, light.height, kSize);
    v.flag({"twoSided", "the rectangle emits from both sides"}, light.twoSided);
    v.number({"angularDiameter", "angular diameter of a directional light, degrees"}, light.angularDiameter,
             {0, 90});
}

template <typename T>
T read(const JsonNode& extension, Faults& faults) {
    T value;
    JsonReader::read(extension.json(), extension.place(), faults, value);
    return value;
}

void checkLight(const VendorLight& given, PunctualType type, const std::string& place, Faults& faults) {
    const bool directional = type == PunctualType::directional;
    if (given.angularDiameter && !directional)
        faults.add(place + "/angularDiameter", "applies to directional lights only");
    if (given.radius && type != PunctualType::point)
        faults.add(place + "/radius", "applies to point lights only");
    if (given.width.has_value() != given.height.has_value())
        faults.add(place, "must have both width and height");
    if ((given.width || given.twoSided) && directional)
        faults.add(place, "cannot make a directional light a rectangle");
    if (given.radius && given.width) faults.add(place, "must be either a sphere or a rectangle");
    if (given.twoSided && !given.width) faults.add(place + "/twoSided", "applies to rectangles only");
}

}  // namespace

void readVendorMaterial(const JsonNode& extension, Material& material) {
    if (!extension) return;
    Faults faults;
    const auto given = read<VendorMaterial>(extension, faults);
    checkAppearance(given, extension.place(), faults);
    faults.throwIfAny(ErrorCode::invalidArgument, extension.fileName());
    applyOverride(material, given);
}

std::optional<AreaLight> readVendorLight(const JsonNode& extension, PunctualLight& light) {
    if (!extension) return std::nullopt;
    Faults faults;
    const auto given = read<VendorLight>(extension, faults);
    checkLight(given, light.type, extension.place(), faults);
    faults.throwIfAny(ErrorCode::invalidArgument, extension.fileName());
    constexpr double pi = std::numbers::pi;
    if (given.angularDiameter) light.angularRadius = static_cast<float>(*given.angularDiameter * pi / 360);
    AreaLight area;
    area.name = light.name;
    if (given.radius) {
        area.shape = AreaShape::sphere;
        area.radius = *given.radius;
        // Seen from afar it is a disk of radiance L and area π r².
        area.radiance = glm::dvec3(light.color) / (pi * area.radius * area.radius);
        return area;
    }
    if (!given.width) return std::nullopt;
    // It shines along the node's -z as spots do: u × v.
    area.u = {*given.width / 2, 0, 0};
    area.v = {0, -*given.height / 2, 0};
    area.twoSided = given.twoSided;
    area.radiance = glm::dvec3(light.color) / (*given.width * *given.height);
    return area;
}

}  // namespace tilefarm
