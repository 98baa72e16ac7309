#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "shared/error/error.h"
#include "worker/scene/load.h"
#include "worker/scene/mesh_repair.h"

namespace tilefarm {
namespace {

constexpr double kFramingFov = 40.0 * glm::pi<double>() / 180.0;
constexpr double kMargin = 1.1;
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

glm::dvec3 middleOf(const std::vector<glm::dvec3>& corners) {
    glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    for (glm::dvec3 corner : corners) {
        lower = glm::min(lower, corner);
        upper = glm::max(upper, corner);
    }
    return corners.empty() ? glm::dvec3(0) : lower + (upper - lower) * 0.5;
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

glm::dvec3 middleOf(const Scene& scene) {
    return middleOf(boxCorners(scene));
}

Camera framingCamera(const Scene& scene, double imageAspect) {
    const std::vector<glm::dvec3> corners = boxCorners(scene);
    const glm::dvec3 centre = middleOf(corners);
    const glm::dvec3 back(std::sin(kAzimuth) * std::cos(kElevation), std::sin(kElevation),
                          std::cos(kAzimuth) * std::cos(kElevation));
    const glm::dvec3 right = normalizeOrZero(glm::cross(glm::dvec3(0, 1, 0), back));
    const glm::dvec3 up = glm::cross(back, right);
    // Every corner lies within the picture where distance − its depth ≥ its offset / tangent of half the
    // view.
    const double tangentY = std::tan(kFramingFov / 2), tangentX = tangentY * std::max(imageAspect, 1e-3);
    double distance = 0;
    for (glm::dvec3 corner : corners) {
        const glm::dvec3 offset = corner - centre;
        const double across = std::abs(glm::dot(offset, right)) / tangentX;
        const double along = std::abs(glm::dot(offset, up)) / tangentY;
        distance = std::max(distance, glm::dot(offset, back) + kMargin * std::max(across, along));
    }
    if (!(distance > 0) || !std::isfinite(distance)) {
        distance = 1;
    }
    Camera camera;
    camera.name = camera.node = "framing";
    camera.yfov = static_cast<float>(kFramingFov);
    camera.toWorld = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0),
                                glm::dvec4(centre + back * distance, 1));
    return camera;
}

}  // namespace tilefarm
