#include "worker/render/camera_parameters.h"

#include <cmath>

namespace tilefarm {

void setCamera(gpu::FrameParameters& parameters, const Camera& camera, const ImageSpec& image) {
    // Node scales do not belong to a camera's axes.
    const glm::dvec3 right = glm::normalize(glm::dvec3(camera.toWorld[0]));
    const glm::dvec3 up = glm::normalize(glm::dvec3(camera.toWorld[1]));
    const glm::dvec3 back = glm::normalize(glm::dvec3(camera.toWorld[2]));
    const double aspect = double(image.width) / image.height;
    const double halfHeight = camera.orthographic ? double{camera.ymag} : std::tan(0.5 * camera.yfov);
    parameters.cameraOrigin = glm::vec4(glm::vec3(camera.toWorld[3]), 1);
    parameters.cameraForward = glm::vec4(glm::vec3(-back), camera.orthographic ? 1.f : 0.f);
    parameters.cameraRight = glm::vec4(glm::vec3(right * (halfHeight * aspect)), 0);
    parameters.cameraUp = glm::vec4(glm::vec3(up * halfHeight), 0);
}

}  // namespace tilefarm
