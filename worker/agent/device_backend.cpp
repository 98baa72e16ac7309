#include "worker/agent/device_backend.h"

#include <chrono>
#include <optional>
#include <utility>

#include "shared/error/error.h"
#include "worker/render/hidden_lights.h"
#include "worker/scene/timeline.h"

namespace tilefarm {
namespace {

SceneCounts countsOf(const Scene& scene) {
    SceneCounts counts;
    counts.instances = scene.instances.size();
    counts.materials = scene.materials.size();
    counts.images = scene.images.size();
    counts.degenerateTriangles = scene.degenerateTriangles;
    counts.sanitisedTexels = scene.sanitisedTexels;
    return counts;
}

// What the integrator leaves out of what the scene calls for.
void addWarnings(const FeatureReport& features, std::vector<SceneWarning>& warnings) {
    for (const std::string& effect : features.notShown)
        warnings.push_back({effect, "settings.integrator", "this integrator renders without it"});
}

class DeviceBackend : public RenderBackend {
public:
    DeviceBackend(uint32_t index, gpu::DeviceOptions options, uint64_t forcedFeatures)
        : index_(index), options_(options), forcedFeatures_(forcedFeatures) {
        device_.emplace(index_, options_);
        name_ = {device_->info().name, device_->info().driver};
    }

    DeviceName device() const override { return name_; }

    PreparedScene prepare(const JobSpec& spec, const SceneFiles& files) override {
        drop();
        openDevice(spec.settings.integrator == Integrator::raster);
        const auto begin = std::chrono::steady_clock::now();
        timeline_.emplace(spec, files.entry, files.environment);
        frame_ = spec.frames.first;
        Scene& scene = timeline_->scene(frame_, 0);
        const CameraPath camera = timeline_->camera(frame_);
        const std::chrono::duration<double> loading = std::chrono::steady_clock::now() - begin;

        renderer_.emplace(*device_, timeline_->scene(frame_, 0), camera, spec.image, spec.settings,
                          filmLayoutOf(spec), forcedFeatures_);
        if (timeline_->steps() > 1) showScenes();
        PreparedScene prepared;
        prepared.counts = countsOf(scene);
        prepared.counts.triangles = renderer_->triangleCount();
        prepared.counts.lights = renderer_->lights();
        prepared.counts.degenerateTriangles += renderer_->degenerateTriangles();
        prepared.warnings = scene.warnings;
        const std::vector<SceneWarning>& ofView = renderer_->warnings();
        prepared.warnings.insert(prepared.warnings.end(), ofView.begin(), ofView.end());
        prepared.features = renderer_->features();
        addWarnings(prepared.features, prepared.warnings);
        for (SceneWarning& warning : hiddenLights(scene, spec.settings))
            prepared.warnings.push_back(std::move(warning));
        prepared.loadSeconds = loading.count();
        prepared.times = renderer_->prepareTimes();
        timeline_->release();
        return prepared;
    }

    std::vector<PassFilm> render(int32_t frame, std::span<const uint32_t> tiles,
                                 SampleRange samples) override {
        if (!renderer_) throw Error(ErrorCode::internal, "no scene is loaded");
        show(frame);
        return renderer_->render(frame, tiles, samples);
    }

    SampleTrace trace(int32_t frame, uint32_t x, uint32_t y, uint32_t sample) override {
        if (!renderer_) throw Error(ErrorCode::internal, "no scene is loaded");
        show(frame);
        return renderer_->trace(frame, x, y, sample);
    }

    RenderStats stats() const override { return renderer_ ? renderer_->stats() : RenderStats{}; }

    void drop() override {
        renderer_.reset();
        timeline_.reset();
    }

    void reset() override {
        drop();
        device_.reset();
    }

private:
    // Once a job has asked for drawing, the device is kept with a queue that draws.
    void openDevice(bool draws) {
        if (device_ && (!draws || device_->limits().graphics)) return;
        device_.reset();
        gpu::DeviceOptions options = options_;
        options.graphics |= draws;
        device_.emplace(index_, options);
    }

    // Only what differs between frames: the camera, and the scene where it moves.
    void show(int32_t frame) {
        if (frame == frame_) return;
        frame_ = frame;
        renderer_->setCamera(timeline_->camera(frame));
        if (timeline_->moves()) showScenes();
    }

    void showScenes() {
        renderer_->setScenes(timeline_->steps(), [this](uint32_t step) -> const Scene& {
            return timeline_->scene(frame_, step);
        });
    }

    uint32_t index_;
    gpu::DeviceOptions options_;
    uint64_t forcedFeatures_;
    DeviceName name_;
    std::optional<gpu::Device> device_;  // outlives the renderer
    std::optional<Renderer> renderer_;
    std::optional<Timeline> timeline_;
    int32_t frame_ = 0;  // that renderer_ holds
};

}  // namespace

std::unique_ptr<RenderBackend> makeDeviceBackend(uint32_t device, gpu::DeviceOptions options,
                                                 uint64_t forcedFeatures) {
    return std::make_unique<DeviceBackend>(device, options, forcedFeatures);
}

}  // namespace tilefarm
