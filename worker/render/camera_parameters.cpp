#include "worker/render/camera_parameters.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr float kFarthest = 1e30f;  // m, of rays

// Node scales do not belong to a camera's axes.
glm::dmat3 axesOf(const Camera& camera) {
    return {glm::normalize(glm::dvec3(camera.toWorld[0])), glm::normalize(glm::dvec3(camera.toWorld[1])),
            glm::normalize(glm::dvec3(camera.toWorld[2]))};
}

double halfHeightOf(const Camera& camera) {
    return camera.orthographic ? double{camera.ymag} : std::tan(0.5 * camera.yfov);
}

double aspectOf(const ImageSpec& image) {
    return double(image.width) / image.height;
}

float kindOf(const Camera& camera) {
    if (camera.panorama) return static_cast<float>(CAMERA_PANORAMA);
    return static_cast<float>(camera.orthographic ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE);
}

// Three vectors for shaders/camera.glsl.
void setKey(gpu::vec4* key, const Camera& camera, const std::optional<glm::dvec3>& pivot, double aspect,
            const gpu::vec4* before) {
    const glm::dmat3 axes = axesOf(camera);
    const glm::dquat q = glm::normalize(glm::quat_cast(axes));
    const glm::dvec3 position(camera.toWorld[3]), around = pivot.value_or(position);
    key[0] = gpu::vec4(q.x, q.y, q.z, q.w);
    if (before && glm::dot(*before, key[0]) < 0) key[0] = -key[0];  // the shorter way
    key[1] = gpu::vec4(glm::vec3(around), halfHeightOf(camera));
    key[2] = gpu::vec4(glm::vec3(glm::transpose(axes) * (position - around)), aspect);
}

}  // namespace

void setCamera(gpu::FrameParameters& parameters, const Camera& camera, const ImageSpec& image) {
    const glm::dmat3 axes = axesOf(camera);
    const double halfHeight = halfHeightOf(camera);
    parameters.cameraOrigin = glm::vec3(camera.toWorld[3]);
    parameters.cameraForward = glm::vec3(-axes[2]);
    parameters.cameraKind = kindOf(camera);
    parameters.cameraRight = glm::vec3(axes[0] * (halfHeight * aspectOf(image)));
    parameters.cameraUp = glm::vec3(axes[1] * halfHeight);
    parameters.lensRadius = static_cast<float>(camera.apertureRadius);
    parameters.lensInverseFocus = static_cast<float>(1 / camera.focusDistance);
    parameters.lensBlades = static_cast<float>(camera.blades);
    parameters.lensRotation = static_cast<float>(camera.bladeRotation);
}

void setCameraPath(gpu::FrameParameters& parameters, const CameraPath& path, const ImageSpec& image) {
    if (path.keys.empty() || path.keys.size() > gpu::CAMERA_KEYS)
        throw Error(ErrorCode::invalidArgument, "a camera's path has 1 to " +
                                                    std::to_string(gpu::CAMERA_KEYS) + " keys, not " +
                                                    std::to_string(path.keys.size()));
    setCamera(parameters, path.keys.front(), image);
    parameters.cameraKeyCount = static_cast<uint32_t>(path.keys.size());
    if (path.keys.size() == 1) return;
    for (size_t i = 0; i < path.keys.size(); ++i) {
        gpu::vec4* key = parameters.cameraKeys + i * gpu::CAMERA_KEY_VECTORS;
        setKey(key, path.keys[i], path.pivot, aspectOf(image),
               i > 0 ? key - gpu::CAMERA_KEY_VECTORS : nullptr);
    }
}

uint64_t setCulling(gpu::FrameParameters& parameters, const BackFaces& backFaces, const CameraPath& path,
                    Culling culling) {
    const Camera& camera = path.keys.front();
    if (culling == Culling::all && backFaces.any()) parameters.cullingKind = gpu::CULLING_ALL;
    if (culling == Culling::camera && backFaces.mayBeSeen(path)) parameters.cullingKind = gpu::CULLING_CAMERA;
    parameters.cameraClips = camera.clips && !camera.panorama ? 1 : 0;
    parameters.clipping = {camera.znear, std::min(camera.zfar, kFarthest)};
    const bool needed = parameters.cullingKind != gpu::CULLING_NONE || parameters.cameraClips != 0;
    return needed ? gpu::bit(gpu::FEATURE_CULLING) : 0;
}

uint64_t featuresOf(const CameraPath& path) {
    const Camera& camera = path.keys.front();
    uint64_t features = 0;
    if (camera.orthographic) features |= gpu::bit(gpu::FEATURE_ORTHOGRAPHIC);
    if (camera.panorama) features |= gpu::bit(gpu::FEATURE_PANORAMA);
    if (camera.apertureRadius > 0) features |= gpu::bit(gpu::FEATURE_THIN_LENS);
    if (path.keys.size() > 1) features |= gpu::bit(gpu::FEATURE_CAMERA_MOTION);
    return features;
}

}  // namespace tilefarm
