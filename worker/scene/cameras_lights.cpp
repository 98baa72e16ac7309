#include "worker/scene/cameras_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "worker/scene/extensions.h"
#include "worker/scene/vendor_extensions.h"

namespace tilefarm {
namespace {

/// A number greater than 0 that a float holds.
float positive(const JsonNode& node) {
    const double value = node.number();
    const auto rounded = static_cast<float>(value);
    if (!(rounded > 0) || !std::isfinite(rounded)) {
        node.fail(fmt::format("must be greater than 0, is {}", value));
    }
    return rounded;
}

/// Viewers take the absolute value of the half sizes, and so do we.
float halfSize(const JsonNode& node) {
    const auto value = static_cast<float>(std::abs(node.number()));
    if (!(value > 0) || !std::isfinite(value)) {
        node.fail("must not be 0");
    }
    return value;
}

/// A tracer of rays needs no such planes; files whose planes nobody could use are rendered without them.
void parseClipping(LoadContext& load, const JsonNode& node, Camera& camera) {
    const JsonNode znear = node["znear"], zfar = node["zfar"];
    const double nearest = znear.numberOr(0),
                 farthest = zfar.numberOr(std::numeric_limits<double>::infinity());
    if (nearest < 0 || farthest <= nearest) {
        const bool isNegative = nearest < 0;
        load.warn(isNegative ? "znear" : "zfar", node,
                  isNegative ? "is below 0, so the camera has none"
                             : "is not beyond znear, so the camera has neither");
        return;
    }
    camera.znear = static_cast<float>(nearest);
    camera.zfar = static_cast<float>(farthest);
}

Camera parseCamera(LoadContext& load, const JsonNode& node) {
    Camera camera;
    camera.name = node["name"].textOr("");
    const std::string& type = node["type"].text();
    if (type == "perspective") {
        const JsonNode perspective = node["perspective"];
        camera.yfov = positive(perspective["yfov"]);
        if (camera.yfov >= std::numbers::pi_v<float>) {
            perspective["yfov"].fail(fmt::format("must be less than pi, is {}", camera.yfov));
        }
        if (const JsonNode aspect = perspective["aspectRatio"]) {
            camera.aspect = positive(aspect);
        }
        parseClipping(load, perspective, camera);
    } else if (type == "orthographic") {
        camera.orthographic = true;
        camera.xmag = halfSize(node["orthographic"]["xmag"]);
        camera.ymag = halfSize(node["orthographic"]["ymag"]);
        camera.aspect = camera.xmag / camera.ymag;
        parseClipping(load, node["orthographic"], camera);
    } else {
        node["type"].fail(fmt::format("is \"{}\", must be perspective or orthographic", type));
    }
    return camera;
}

PunctualType parseType(const JsonNode& node) {
    const std::string& type = node.text();
    if (type == "point") return PunctualType::point;
    if (type == "spot") return PunctualType::spot;
    if (type == "directional") return PunctualType::directional;
    node.fail(fmt::format("is \"{}\", must be point, spot or directional", type));
}

/// rad: what degrees and single precision leave of two angles that are meant to be one.
constexpr double kRounding = 1e-4;

void parseCone(const JsonNode& spot, PunctualLight& light) {
    constexpr double quarter = std::numbers::pi / 2;
    const double inner = spot["innerConeAngle"].numberOr(0);
    const double outer = spot["outerConeAngle"].numberOr(quarter / 2);
    const std::string fault =
        fmt::format("its cones must be 0 <= inner <= outer <= pi/2, are {} and {}", inner, outer);
    if (!(inner >= -kRounding && inner <= outer + kRounding && outer >= 0 && outer <= quarter + kRounding)) {
        spot.fail(fault);
    }
    // A float's pi/2 is a little more than pi/2, which is no fault.
    if (!(inner >= 0 && inner <= outer && outer <= quarter + 1e-6)) {
        spot.tolerate(fault, "rendered with the nearest that are");
    }
    light.innerCone = static_cast<float>(std::clamp(inner, 0.0, std::min(outer, quarter)));
    light.outerCone = static_cast<float>(std::min(outer, quarter));
}

PunctualLight parseLight(const JsonNode& node, double unit) {
    PunctualLight light;
    light.name = node["name"].textOr("");
    light.type = parseType(node["type"]);
    const double intensity = node["intensity"].numberOr(1) * unit;
    glm::dvec3 color(1);
    if (const JsonNode given = node["color"]) {
        const std::vector<double> v = given.numbers(3);
        color = {v[0], v[1], v[2]};
    }
    light.color = color * intensity;
    for (int c = 0; c < 3; ++c) {
        if (!(light.color[c] >= 0) || !std::isfinite(light.color[c])) {
            node.fail("its colour times intensity must be finite and not negative");
        }
    }
    if (const JsonNode range = node["range"]; range && light.type != PunctualType::directional) {
        if (range.number() == 0) {
            range.tolerate("must be greater than 0, is 0", "read as if it were not given: no end");
        } else {
            light.range = positive(range);
        }
    }
    if (light.type == PunctualType::spot) {
        parseCone(node["spot"], light);
    }
    return light;
}

/// What an area light has no use for.
void warnOfPunctualMembers(LoadContext& load, const JsonNode& node) {
    if (node["range"]) {
        load.warn("range", node, "a light with a surface reaches everywhere");
    }
    if (node["spot"]) {
        load.warn("spot", node, "a rectangle shines into its whole half space, without a cone");
    }
}

GltfLight readLight(LoadContext& load, const JsonNode& node) {
    GltfLight light;
    light.punctual = parseLight(node, load.lightUnit);
    light.area = readVendorLight(node["extensions"]["TILEFARM_lights"], light.punctual);
    warnOfNotRendered(load, node);
    if (light.area) {
        warnOfPunctualMembers(load, node);
    }
    return light;
}

}  // namespace

PartList<Camera> parseCameras(LoadContext& load) {
    const JsonNode nodes = load.file.root()["cameras"];
    PartList<Camera> cameras;
    for (size_t i = 0; i < nodes.size(); ++i) {
        cameras.add(nodes[i], [&] { return parseCamera(load, nodes[i]); });
    }
    return cameras;
}

PartList<GltfLight> parseLights(LoadContext& load) {
    const JsonNode nodes = load.file.root()["extensions"]["KHR_lights_punctual"]["lights"];
    PartList<GltfLight> lights;
    for (size_t i = 0; i < nodes.size(); ++i) {
        lights.add(nodes[i], [&] { return readLight(load, nodes[i]); });
    }
    return lights;
}

}  // namespace tilefarm
