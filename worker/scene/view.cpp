#include "worker/scene/view.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "worker/scene/transform.h"
#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

double apertureRadiusOf(const Camera& camera, const ViewSettings& view, double imageAspect) {
    if (view.fNumber <= 0) {
        return view.apertureRadius;
    }
    const double tangentX = std::tan(0.5 * camera.yfov) * imageAspect;
    const double focalLength = view.sensorWidth / (2 * tangentX);
    return focalLength / (2 * view.fNumber);
}

double focusDistanceOf(const Camera& camera, const ViewSettings& view, const glm::dvec3& middle) {
    if (view.focusDistance > 0) {
        return view.focusDistance;
    }
    if (view.kind != ViewKind::scene) {
        return glm::length(vectorOf(view.target) - vectorOf(view.eye));
    }
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(camera.toWorld[2]));
    const double distance = glm::dot(middle - glm::dvec3(camera.toWorld[3]), forward);
    return distance > 0 ? distance : 1;
}

}  // namespace

Camera placedCamera(const ViewSettings& view) {
    Camera camera;
    camera.name = camera.node = "view";
    camera.orthographic = view.kind == ViewKind::orthographic;
    camera.panorama = view.kind == ViewKind::panorama;
    camera.yfov = static_cast<float>(glm::radians(view.yfov));
    camera.ymag = static_cast<float>(view.height / 2);
    // Of these, withoutScale keeps the direction and as much of what is up as it leaves.
    camera.toWorld[1] = glm::dvec4(vectorOf(view.up), 0);
    camera.toWorld[2] = glm::dvec4(vectorOf(view.eye) - vectorOf(view.target), 0);
    camera.toWorld[3] = glm::dvec4(vectorOf(view.eye), 1);
    camera.toWorld = withoutScale(camera.toWorld);
    return camera;
}

Camera fitted(Camera camera, CameraFit fit, double imageAspect) {
    // Files have their aspects in six digits; a picture of whole pixels is not closer either.
    constexpr double kSame = 1e-5;
    const double narrower = camera.aspect / imageAspect;  // above 1: the picture is narrower than the view
    const bool keepsWidth = fit == CameraFit::horizontal || (fit == CameraFit::fit && narrower > 1) ||
                            (fit == CameraFit::fill && narrower < 1);
    if (camera.panorama || !(camera.aspect > 0) || !keepsWidth || std::abs(narrower - 1) < kSame)
        return camera;
    camera.ymag = static_cast<float>(camera.ymag * narrower);
    camera.yfov = static_cast<float>(2 * std::atan(std::tan(0.5 * camera.yfov) * narrower));
    return camera;
}

void setLens(Camera& camera, const ViewSettings& view, double imageAspect, const glm::dvec3& middle) {
    if (camera.orthographic || camera.panorama) {
        return;
    }
    camera.apertureRadius = static_cast<float>(apertureRadiusOf(camera, view, imageAspect));
    camera.focusDistance = static_cast<float>(focusDistanceOf(camera, view, middle));
    camera.blades = view.blades;
    camera.bladeRotation = static_cast<float>(glm::radians(view.bladeRotation));
}

Camera turnedAround(Camera camera, const glm::dvec3& centre, double degrees) {
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 1, 0));
    camera.toWorld = glm::translate(glm::dmat4(1), centre) * turn * glm::translate(glm::dmat4(1), -centre) *
                     camera.toWorld;
    return camera;
}

}  // namespace tilefarm
