#include "worker/scene/timeline.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/scene/apply_job.h"
#include "worker/scene/load.h"
#include "worker/scene/view.h"

namespace tilefarm {
namespace {

// Enough that the straight lines between them leave a path by less than a thousandth of the way.
constexpr size_t kCameraKeys = 17;

}  // namespace

struct Timeline::Impl {
    Impl(const JobSpec& job, const std::filesystem::path& entry, const std::filesystem::path& environment)
        : spec(job),
          source(std::in_place, entry, gltfOptionsOf(job)),
          animated(source->animated()),
          moves(source->moves()),
          aspect(static_cast<double>(job.image.width) / job.image.height) {
        Scene& first = at(0);
        // Both by the first moment alone, so that they do not depend on the frames rendered here.
        setJobEnvironment(first, spec, environment);
        setJobFog(first, spec);
        middle = middleOf(first);
        if (spec.view.kind == ViewKind::scene) still = selectCamera(first, spec.camera, aspect);
    }

    double secondsOf(int32_t frame, double share) const {
        return (frame + share * spec.motion.shutter) / spec.motion.fps;
    }

    Scene& at(double seconds) {
        if (shown && (*shown == seconds || !animated)) return *scene;
        scene = &source->at(seconds);
        addJobLights(*scene, spec);
        shown = seconds;
        return *scene;
    }

    /// At a share of the time that the frame's shutter is open.
    Camera cameraAt(int32_t frame, double share) {
        Camera camera = spec.view.kind == ViewKind::scene ? still : placedCamera(spec.view);
        if (spec.view.kind == ViewKind::scene && animated) {
            const Scene& now = at(secondsOf(frame, share));
            if (!now.cameras.empty()) camera = selectCamera(now, spec.camera, aspect);
        }
        camera = fitted(camera, spec.settings.cameraFit, aspect);
        camera.clips = spec.settings.cameraClip;
        setLens(camera, spec.view, aspect, middle);
        if (spec.motion.turntable == 0) return camera;
        return turnedAround(camera, middle, spec.motion.turntable * (frame + share * spec.motion.shutter));
    }

    JobSpec spec;
    std::optional<GltfSource> source;
    bool animated, moves;
    double aspect;
    Scene* scene = nullptr;
    std::optional<double> shown;  // moment of `scene`
    glm::dvec3 middle{0};
    Camera still;  // the one chosen, at the first moment
};

Timeline::Timeline(const JobSpec& spec, const std::filesystem::path& entry,
                   const std::filesystem::path& environment)
    : impl_(std::make_unique<Impl>(spec, entry, environment)) {}
Timeline::~Timeline() = default;
Timeline::Timeline(Timeline&&) noexcept = default;

bool Timeline::moves() const {
    return impl_->moves;
}

uint32_t Timeline::steps() const {
    return moves() && impl_->spec.motion.shutter > 0 ? impl_->spec.motion.shutterSteps : 1;
}

void Timeline::release() {
    if (!impl_->animated) impl_->source.reset();
}

Scene& Timeline::scene(int32_t frame, uint32_t step) {
    return impl_->at(impl_->secondsOf(frame, steps() == 1 ? 0 : (step + 0.5) / steps()));
}

CameraPath Timeline::camera(int32_t frame) {
    CameraPath path{{impl_->cameraAt(frame, 0)}, std::nullopt};
    if (impl_->spec.motion.shutter == 0) return path;
    for (size_t i = 1; i < kCameraKeys; ++i)
        path.keys.push_back(impl_->cameraAt(frame, static_cast<double>(i) / (kCameraKeys - 1)));
    const Camera& first = path.keys.front();
    const bool moved = std::any_of(path.keys.begin(), path.keys.end(), [&](const Camera& key) {
        return key.toWorld != first.toWorld || key.yfov != first.yfov || key.ymag != first.ymag;
    });
    if (!moved) path.keys.resize(1);
    if (moved && impl_->spec.motion.turntable != 0) path.pivot = impl_->middle;
    return path;
}

}  // namespace tilefarm
