#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "shared/error/error.h"
#include "worker/scene/load.h"
#include "worker/scene/mesh_repair.h"

namespace tilefarm {
namespace {

constexpr double kFramingFov = 40.0 * glm::pi<double>() / 180.0;
constexpr double kMargin = 1.05;
constexpr double kElevation = 18.0 * glm::pi<double>() / 180.0;
constexpr double kAzimuth = 25.0 * glm::pi<double>() / 180.0;  // towards +x from the front, +z

/// The eight corners of the meshes' boxes, in world space: close enough to frame, and quick for any scene.
std::vector<glm::dvec3> boxCorners(const Scene& scene) {
    std::vector<glm::dvec3> corners;
    std::vector<std::pair<glm::vec3, glm::vec3>> boxes;
    for (const Mesh& mesh : scene.meshes) {
        glm::vec3 lower(std::numeric_limits<float>::infinity()), upper = -lower;
        for (glm::vec3 position : mesh.positions) {
            lower = glm::min(lower, position);
            upper = glm::max(upper, position);
        }
        boxes.emplace_back(lower, upper);
    }
    for (const Instance& instance : scene.instances) {
        const auto& [lower, upper] = boxes[instance.mesh];
        for (int i = 0; i < 8 && lower.x <= upper.x; ++i) {
            const glm::dvec3 corner(i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y,
                                    i & 4 ? upper.z : lower.z);
            corners.emplace_back(instance.toWorld * glm::dvec4(corner, 1));
        }
    }
    return corners;
}

std::string listOf(const std::vector<Camera>& cameras) {
    std::string list;
    for (const Camera& camera : cameras) {
        list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", camera.name);
        list += camera.node == camera.name ? "" : fmt::format(" at \"{}\"", camera.node);
    }
    return list.empty() ? "none" : list;
}

}  // namespace

Camera selectCamera(const Scene& scene, const std::string& name, double imageAspect) {
    for (const Camera& camera : scene.cameras) {
        if (name == "auto" || camera.name == name) {
            return camera;
        }
    }
    for (const Camera& camera : scene.cameras) {
        if (camera.node == name) {
            return camera;
        }
    }
    if (name == "auto") {
        return framingCamera(scene, imageAspect);
    }
    throw Error(ErrorCode::invalidArgument,
                fmt::format("the scene has no camera \"{}\"; it has {}", name, listOf(scene.cameras)));
}

Camera framingCamera(const Scene& scene, double imageAspect) {
    const std::vector<glm::dvec3> corners = boxCorners(scene);
    glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    for (glm::dvec3 corner : corners) {
        lower = glm::min(lower, corner);
        upper = glm::max(upper, corner);
    }
    const glm::dvec3 centre = corners.empty() ? glm::dvec3(0) : lower + (upper - lower) * 0.5;
    double radius = 0;
    for (glm::dvec3 corner : corners) {
        radius = std::max(radius, glm::length(corner - centre));
    }
    if (!(radius > 0) || !std::isfinite(radius)) {
        radius = 1;
    }
    // The sphere touches the cone of the narrower field of view.
    const double halfY = kFramingFov / 2;
    const double halfX = std::atan(std::tan(halfY) * std::max(imageAspect, 1e-3));
    const double distance = kMargin * radius / std::sin(std::min(halfX, halfY));
    const glm::dvec3 back(std::sin(kAzimuth) * std::cos(kElevation), std::sin(kElevation),
                          std::cos(kAzimuth) * std::cos(kElevation));
    const glm::dvec3 right = normalizeOrZero(glm::cross(glm::dvec3(0, 1, 0), back));
    Camera camera;
    camera.name = camera.node = "framing";
    camera.yfov = static_cast<float>(kFramingFov);
    camera.toWorld = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0),
                                glm::dvec4(back, 0), glm::dvec4(centre + back * distance, 1));
    return camera;
}

}  // namespace tilefarm
