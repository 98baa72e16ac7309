#include "worker/render/renderer.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>

#include "shared/error/error.h"
#include "worker/render/camera_parameters.h"
#include "worker/render/dispatch_budget.h"
#include "worker/render/dispatch_counts.h"
#include "worker/render/features.h"
#include "worker/render/gpu_scene.h"
#include "worker/render/integrators.h"
#include "worker/render/output_features.h"
#include "worker/render/path_rules.h"
#include "worker/render/raster_pass.h"
#include "worker/render/sample_parameters.h"
#include "worker/scene/view_warnings.h"
#include "worker/vk/commands.h"

namespace tilefarm {
namespace {

// The largest storage buffer that lavapipe binds: a film of 2^21 pixels.
constexpr uint64_t kFilmBytes = uint64_t{128} << 20;
constexpr uint32_t kSamplesPerDraw = 16;  // of one run of draws, each with the whole scene
constexpr uint32_t kGroupSize = 8;

// What a kernel is compiled for.
struct KernelShape {
    uint64_t features = 0;
    uint32_t vertexTexels = 0, stackSize = 0;
    friend bool operator==(const KernelShape&, const KernelShape&) = default;
};

gpu::PipelineSpec pipelineSpec(const IntegratorKernel& kernel, const KernelShape& shape) {
    gpu::PipelineSpec spec;
    spec.spirv = kernel.spirv;
    spec.bindings.assign((kernel.draws ? gpu::BINDING_SHAPE_SLOTS : gpu::BINDING_COUNTERS) + 1,
                         gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    spec.constants.resize(gpu::SPEC_COUNT);
    spec.constants[gpu::SPEC_FEATURES] = static_cast<uint32_t>(shape.features);
    spec.constants[gpu::SPEC_FEATURES_HIGH] = static_cast<uint32_t>(shape.features >> 32);
    spec.constants[gpu::SPEC_VERTEX_TEXELS] = shape.vertexTexels;
    spec.constants[gpu::SPEC_STACK_SIZE] = shape.stackSize;
    spec.pushConstantBytes = sizeof(gpu::PassConstants);
    spec.name = kernel.name;
    return spec;
}

float largestCoordinate(const glm::vec3& v) {
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}

// The scene of one part of the shutter's time, which may be all of it.
struct Moment {
    GpuScene scene;
    glm::dvec3 centre;
    uint64_t degenerateTriangles = 0;
    glm::vec3 lower{0}, upper{0};  // its box
    BackFaces backFaces;
    uint32_t vertices = 0;  // of a draw
    gpu::FrameParameters parameters{};
    gpu::StorageBuffer parameterBuffer;
    std::vector<gpu::Binding> bindings;
};

}  // namespace

struct Renderer::Impl {
    Impl(const gpu::Device& on, const Scene& source, const CameraPath& camera, const ImageSpec& size,
         const RenderSettings& settings, const FilmLayout& channels, uint64_t forced);

    void setCamera(const CameraPath& path);
    void setScenes(uint32_t steps, const std::function<const Scene&(uint32_t)>& sceneOf);
    std::vector<PassFilm> render(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples);
    SampleTrace trace(int32_t frame, uint32_t x, uint32_t y, uint32_t sample);

    const gpu::Device& device;
    const ImageSpec image;
    const RenderSettings settings;
    const IntegratorKernel kernel;
    const IntegratorParameters integrator;
    TileGrid grid;
    PrepareTimes times;
    FeatureReport features;
    uint64_t wanted;  // FEATURE_* that some moment so far has called for
    const FilmLayout layout;
    KernelShape compiled;
    CameraPath camera;
    std::vector<SceneWarning> warnings;  // of the first moment
    std::vector<Moment> moments;         // in the order of time
    std::optional<RasterPass> raster;
    std::optional<gpu::ComputePipeline> pipeline;
    uint32_t tilesPerBatch;
    gpu::StorageBuffer tileBuffer, filmBuffer, counterBuffer;
    RenderStats stats;
    DispatchBudget budget;

private:
    Moment makeMoment(const Scene& scene, uint64_t forced, const GpuScene* like);
    void setParameters(int32_t frame);
    void compileIfNeeded();
    void renderBatch(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples,
                     std::vector<PassFilm>& films);
    void uploadTiles(std::span<const uint32_t> tiles);
    std::vector<uint32_t> dispatch(const Moment& moment, uint32_t tileCount,
                                   const gpu::PassConstants& constants, uint32_t rows);
    uint32_t tilesPerDispatch() const;
    uint32_t rowsPerDispatch(size_t tiles) const;
    void renderRows(const Moment& moment, gpu::PassConstants pass, std::span<const uint32_t> tiles,
                    std::span<PassFaults> faults);
    void countFaults(const DispatchCounts& counts, std::span<const uint32_t> tiles,
                     std::span<PassFaults> faults);
    bool traces() const { return (wanted & kernel.shows & gpu::bit(gpu::FEATURE_TRACE)) != 0; }
    uint64_t filmBytes() const;
    PassFilm cropped(uint32_t tile, SampleRange samples, const std::byte* film) const;
    uint64_t tileBytes() const { return kernelBytes(layout) * image.tileSize * image.tileSize; }
};

Renderer::Impl::Impl(const gpu::Device& on, const Scene& source, const CameraPath& path,
                     const ImageSpec& size, const RenderSettings& how, const FilmLayout& channels,
                     uint64_t forced)
    : device(on),
      image(size),
      settings(how),
      kernel(kernelOf(how.integrator)),
      integrator(how, source.environment),
      grid(size),
      wanted(samplingFeatures(how) | pathRuleFeatures(how) | kernel.calls | outputFeatures(channels) |
             forced),
      layout(layoutOf((outputFeatures(channels) | forced) & kernel.shows)),
      camera(path),
      tilesPerBatch(
          traces() ? 1
                   : static_cast<uint32_t>(std::clamp<uint64_t>(kFilmBytes / tileBytes(), 1, grid.count()))),
      tileBuffer(on, sizeof(gpu::uvec4) * tilesPerBatch, "tiles"),
      filmBuffer(on, filmBytes(), "film"),
      counterBuffer(on, sizeof(uint32_t) * DispatchCounts::words(tilesPerBatch), "counters"),
      budget(on.info().cpu, how.maxBounces) {
    if (kernel.draws) raster.emplace(device, image);
    setScenes(1, [&](uint32_t) -> const Scene& { return source; });
}

Moment Renderer::Impl::makeMoment(const Scene& scene, uint64_t forced, const GpuScene* like) {
    const WorldGeometry world = flatten(scene);
    Moment moment{makeGpuScene(device, scene, world, settings, forced, times, like),
                  world.centre,
                  world.degenerateTriangles,
                  world.lower,
                  world.upper,
                  settings.culling == Culling::none ? BackFaces() : BackFaces(scene, world),
                  0,
                  {},
                  gpu::StorageBuffer(device, sizeof(gpu::FrameParameters), "frame parameters"),
                  {}};
    moment.bindings.assign(moment.scene.buffers.begin(), moment.scene.buffers.end());
    moment.bindings.insert(moment.bindings.end(),
                           {moment.parameterBuffer, tileBuffer, filmBuffer, counterBuffer});
    if (!like)
        warnings = viewWarnings(scene, world, world.recentred(camera.keys.front()),
                                double(image.width) / image.height, moment.backFaces, settings.culling);
    if (raster) {
        const auto table = shapeSlotTable(moment.scene.slots, moment.scene.shapeSlots);
        gpu::StorageBuffer slots(device, table.size() * sizeof(uint32_t), "slots of shapes");
        slots.upload(gpu::bytesOf(table));
        moment.bindings.insert(moment.bindings.end(), {raster->visibility(), slots});
        moment.vertices = verticesOf(moment.scene.slots, moment.scene.shapeSlots.size());
    }
    return moment;
}

void Renderer::Impl::setScenes(uint32_t steps, const std::function<const Scene&(uint32_t)>& sceneOf) {
    std::optional<GpuScene> like;
    if (!moments.empty()) like = std::move(moments.front().scene);
    const auto packedAlike = [&] {
        return std::all_of(moments.begin(), moments.end(), [&](const Moment& m) {
            return m.scene.vertexTexels == moments.front().scene.vertexTexels;
        });
    };
    do {                  // again if an effect begins in the middle: all must be packed for one kernel
        moments.clear();  // before the next ones take memory
        for (uint32_t i = 0; i < steps; ++i) {
            moments.push_back(makeMoment(sceneOf(i), wanted, like ? &*like : nullptr));
            if (!like) like = moments.front().scene;
            wanted |= moments.back().scene.features;
            const GpuScene& packed = moments.back().scene;
            budget.expect(packed.lightGroups > 0 ? packed.lightGroups : std::min(packed.lightCount, 1u));
        }
    } while (!packedAlike());
    compileIfNeeded();
}

void Renderer::Impl::setCamera(const CameraPath& path) {
    camera = path;
    compileIfNeeded();
}

void Renderer::Impl::compileIfNeeded() {
    setParameters(0);
    wanted |= featuresOf(camera);
    if (raster && camera.keys.front().panorama)
        throw Error(ErrorCode::invalidArgument, "the raster integrator cannot render panoramas");
    KernelShape shape{wanted & kernel.shows, moments.front().scene.vertexTexels, compiled.stackSize};
    for (const Moment& moment : moments) shape.stackSize = std::max(shape.stackSize, moment.scene.stackSize);
    if (pipeline && shape == compiled) return;
    // Drivers compile on first use: an empty dispatch keeps that out of the first pass's time.
    const auto start = std::chrono::steady_clock::now();
    compiled = shape;
    features = reportFeatures(compiled.features, wanted & ~kernel.indifferent);
    const gpu::PipelineSpec spec = pipelineSpec(kernel, compiled);
    pipeline.emplace(device, spec);
    if (raster)
        raster->compile(device, spec.constants, (compiled.features & gpu::bit(gpu::FEATURE_SHAPES)) != 0);
    const std::vector<gpu::uvec4> none(tilesPerBatch);
    tileBuffer.upload(gpu::bytesOf(none));
    const RenderStats before = stats;
    dispatch(moments.front(), 1, {0, 0, 1, 0, image.tileSize, 0, 0}, image.tileSize);
    stats = before;
    times.pipelineSeconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Renderer::Impl::setParameters(int32_t frame) {
    for (size_t i = 0; i < moments.size(); ++i) {
        Moment& moment = moments[i];
        gpu::FrameParameters& p = moment.parameters;
        p = {};
        CameraPath moved = camera;
        for (Camera& key : moved.keys) key.toWorld[3] -= glm::dvec4(moment.centre, 0.0);
        if (moved.pivot) *moved.pivot -= moment.centre;
        setCameraPath(p, moved, image);
        setSampling(p, settings);
        setPathRules(p, settings);
        wanted |= setCulling(p, moment.backFaces, moved, settings.culling);
        p.imageSize = {image.width, image.height};
        p.seed = settings.seed;
        p.frame = static_cast<uint32_t>(frame);
        p.maxBounces = settings.maxBounces;
        p.rouletteStart = std::max(settings.rouletteStart, 1u);
        setLights(p, moment.scene);
        p.extent = 2 * std::max(largestCoordinate(moment.lower), largestCoordinate(moment.upper));
        integrator.set(p, moment.lower, moment.upper);
        setFog(p, moment.scene.fog, moved);
        wanted |= setMedia(p, moment.scene.solids, glm::dvec3(moved.keys.front().toWorld[3]));
        const double share = 1.0 / static_cast<double>(moments.size());
        p.shutterBegin = static_cast<float>(static_cast<double>(i) * share);
        p.shutterLength = static_cast<float>(share);
        moment.parameterBuffer.upload(gpu::bytesOfValue(p));
    }
}

void Renderer::Impl::uploadTiles(std::span<const uint32_t> tiles) {
    std::vector<Rect> rects;
    std::vector<gpu::uvec4> texels;
    for (const uint32_t tile : tiles) {
        const Rect& r = rects.emplace_back(grid.rect(tile));
        texels.emplace_back(r.x, r.y, r.width, r.height);
    }
    tileBuffer.upload(gpu::bytesOf(texels));
    if (raster) raster->setTiles(rects);
}

// A trace stands behind the film of one tile: a step for every scattering and every pane before the next, for
// what the last ray met, and an end.
uint64_t Renderer::Impl::filmBytes() const {
    const uint64_t steps = traces() ? (uint64_t{settings.maxBounces} + 1) * (gpu::MOST_PANES + 1) + 2 : 0;
    return tileBytes() * tilesPerBatch + steps * gpu::TRACE_TEXELS * sizeof(gpu::vec4);
}

// Of one dispatch; `faults` by tile of the batch.
void Renderer::Impl::countFaults(const DispatchCounts& counts, std::span<const uint32_t> tiles,
                                 std::span<PassFaults> faults) {
    counts.forEachDropped([&](const DroppedSample& dropped) {
        const uint32_t tile = dropped.y / image.tileSize * grid.columns + dropped.x / image.tileSize;
        const auto at = std::find(tiles.begin(), tiles.end(), tile) - tiles.begin();
        PassFaults one;
        one.dropped.push_back(dropped);
        faults[static_cast<size_t>(at)].add(one);
    });
    for (size_t i = 0; i < faults.size(); ++i) counts.addTile(i, faults[i]);
}

// Gives the counters. `rows` of the tiles, from pass.firstRow on.
std::vector<uint32_t> Renderer::Impl::dispatch(const Moment& moment, uint32_t tileCount,
                                               const gpu::PassConstants& constants, uint32_t rows) {
    const auto groupsOf = [](uint32_t pixels) { return (pixels + kGroupSize - 1) / kGroupSize; };
    const uint32_t groups = groupsOf(image.tileSize);
    counterBuffer.zero();
    gpu::CommandRun run(device);
    if (raster)
        raster->add(run, *pipeline, moment.bindings, constants, moment.vertices, groups, tileCount);
    else
        run.dispatch(*pipeline, moment.bindings, gpu::bytesOfValue(constants), groups, groupsOf(rows),
                     tileCount);
    const size_t counters = run.read(counterBuffer, 0, sizeof(uint32_t) * DispatchCounts::words(tileCount));
    gpu::Submission submission = run.submit();
    stats.deviceSeconds += submission.wait();
    const std::span<const std::byte> bytes = submission.bytes(counters);
    std::vector<uint32_t> counts(bytes.size() / sizeof(uint32_t));
    std::memcpy(counts.data(), bytes.data(), bytes.size());
    stats.rays += DispatchCounts(counts).rays();
    stats.droppedSamples += DispatchCounts(counts).droppedSamples();
    return counts;
}

PassFilm Renderer::Impl::cropped(uint32_t tile, SampleRange samples, const std::byte* film) const {
    PassFilm result;
    result.tile = tile;
    result.rect = grid.rect(tile);
    result.samples = samples;
    result.pixels.resize(result.rect.area());
    result.layout = layout;
    result.extra.resize(result.rect.area() * layout.floats());
    const uint64_t stride = kernelBytes(layout);
    for (size_t i = 0; i < result.pixels.size(); ++i) {
        const size_t x = i % result.rect.width, y = i / result.rect.width;
        const std::byte* pixel = film + (y * image.tileSize + x) * stride;
        std::memcpy(&result.pixels[i], pixel, sizeof(PassPixel));
        takeExtra(layout, reinterpret_cast<const float*>(pixel + sizeof(PassPixel)),
                  result.extra.data() + i * layout.floats());
    }
    return result;
}

// A draw is of whole tiles, as many as there are.
uint32_t Renderer::Impl::tilesPerDispatch() const {
    const uint64_t pixels = uint64_t{image.tileSize} * image.tileSize;
    return raster ? tilesPerBatch
                  : static_cast<uint32_t>(std::clamp<uint64_t>(budget.samples() / pixels, 1, tilesPerBatch));
}

uint32_t Renderer::Impl::rowsPerDispatch(size_t tiles) const {
    if (raster) return image.tileSize;
    const uint64_t rows = budget.samples() / (uint64_t{image.tileSize} * tiles);
    return static_cast<uint32_t>(std::clamp<uint64_t>(rows / kGroupSize * kGroupSize, kGroupSize, 1u << 16));
}

void Renderer::Impl::renderRows(const Moment& moment, gpu::PassConstants pass,
                                std::span<const uint32_t> tiles, std::span<PassFaults> faults) {
    const uint32_t rows = rowsPerDispatch(tiles.size());
    for (pass.firstRow = 0; pass.firstRow < image.tileSize; pass.firstRow += rows) {
        const std::vector<uint32_t> counts = dispatch(moment, static_cast<uint32_t>(tiles.size()), pass,
                                                      std::min(rows, image.tileSize - pass.firstRow));
        countFaults(DispatchCounts(counts), tiles, faults);
    }
}

// Samples of one moment after those of another, so the order within a pass, and with it its rounding, is
// fixed.
void Renderer::Impl::renderBatch(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples,
                                 std::vector<PassFilm>& films) {
    uploadTiles(tiles);
    uint64_t pixels = 0;
    for (const uint32_t tile : tiles) pixels += grid.rect(tile).area();
    uint64_t most = budget.samples();
    if (raster) most = std::min(most, kSamplesPerDraw * pixels);
    // One sample at a time leaves room for thousands of bounces; 256 of them lost light in some scenes.
    if (device.info().boundedLoops) most = pixels;
    const auto step = static_cast<uint32_t>(std::clamp<uint64_t>(most / pixels, 1, samples.count));
    std::vector<PassFaults> faults(tiles.size());
    const auto moment = static_cast<uint32_t>(moments.size());
    uint32_t continued = 0;
    for (uint32_t i = 0; i < std::min(moment, samples.count); ++i) {
        const uint32_t first = samples.first + i, count = (samples.count - i + moment - 1) / moment;
        for (uint32_t done = 0; done < count; done += step, continued = 1) {
            const uint64_t before = stats.rays;
            const gpu::PassConstants pass{
                first + done * moment, std::min(step, count - done), moment, continued, image.tileSize, 0, 0};
            renderRows(moments[shutterStep(first, moment, settings.seed, frame)], pass, tiles, faults);
            budget.measured(stats.rays - before, pixels * pass.sampleCount);
        }
    }
    stats.samples += pixels * samples.count;

    gpu::CommandRun run(device);
    const size_t film = run.read(filmBuffer, 0, tileBytes() * tiles.size());
    gpu::Submission submission = run.submit();
    const std::byte* bytes = submission.bytes(film).data();
    for (size_t i = 0; i < tiles.size(); ++i) {
        films.push_back(cropped(tiles[i], samples, bytes + i * tileBytes()));
        films.back().faults = faults[i];
        stats.faults.add(faults[i]);
    }
}

std::vector<PassFilm> Renderer::Impl::render(int32_t frame, std::span<const uint32_t> tiles,
                                             SampleRange samples) {
    for (const uint32_t tile : tiles)
        if (tile >= grid.count())
            throw Error(ErrorCode::invalidArgument, "tile " + std::to_string(tile) +
                                                        " is outside the image's " +
                                                        std::to_string(grid.count()) + " tiles");
    setParameters(frame);
    std::vector<PassFilm> films;
    films.reserve(tiles.size());
    for (size_t first = 0; first < tiles.size();) {
        const size_t count = std::min<size_t>(tilesPerDispatch(), tiles.size() - first);
        renderBatch(frame, tiles.subspan(first, count), samples, films);
        first += count;
    }
    return films;
}

SampleTrace Renderer::Impl::trace(int32_t frame, uint32_t x, uint32_t y, uint32_t sample) {
    if (!traces()) throw Error(ErrorCode::invalidArgument, "this renderer was not made for tracing samples");
    if (x >= image.width || y >= image.height)
        throw Error(ErrorCode::invalidArgument,
                    "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") is outside of the image");
    setParameters(frame);
    tileBuffer.upload(gpu::bytesOfValue(gpu::uvec4(x, y, 1, 1)));
    const auto steps = static_cast<uint32_t>(moments.size());
    dispatch(moments[shutterStep(sample, steps, settings.seed, frame)], 1,
             {sample, 1, 1, 0, image.tileSize, 0, 0}, image.tileSize);
    std::vector<gpu::vec4> texels((filmBytes() - tileBytes()) / sizeof(gpu::vec4));
    filmBuffer.read(std::as_writable_bytes(std::span(texels)), tileBytes());
    SampleTrace result;
    for (size_t i = 0; i + gpu::TRACE_TEXELS <= texels.size(); i += gpu::TRACE_TEXELS) {
        const gpu::vec4 at = texels[i], weight = texels[i + 1], light = texels[i + 2];
        result.radiance = light;
        if (at.w < 0) break;
        result.steps.push_back({at, at.w, weight, weight.w, light, std::bit_cast<uint32_t>(light.w)});
    }
    return result;
}

Renderer::Renderer(const gpu::Device& device, const Scene& scene, const Camera& camera,
                   const ImageSpec& image, const RenderSettings& settings, const FilmLayout& channels,
                   uint64_t forced)
    : Renderer(device, scene, CameraPath{{camera}, std::nullopt}, image, settings, channels, forced) {}

Renderer::Renderer(const gpu::Device& device, const Scene& scene, const CameraPath& camera,
                   const ImageSpec& image, const RenderSettings& settings, const FilmLayout& channels,
                   uint64_t forced)
    : impl_(std::make_unique<Impl>(device, scene, camera, image, settings, channels, forced)) {}

Renderer::~Renderer() = default;

std::vector<PassFilm> Renderer::render(int32_t frame, std::span<const uint32_t> tiles, SampleRange samples) {
    return impl_->render(frame, tiles, samples);
}

SampleTrace Renderer::trace(int32_t frame, uint32_t x, uint32_t y, uint32_t sample) {
    return impl_->trace(frame, x, y, sample);
}

void Renderer::setCamera(const CameraPath& path) {
    impl_->setCamera(path);
}
void Renderer::setScenes(uint32_t steps, const std::function<const Scene&(uint32_t step)>& sceneOf) {
    impl_->setScenes(steps, sceneOf);
}
const RenderStats& Renderer::stats() const {
    return impl_->stats;
}
const FeatureReport& Renderer::features() const {
    return impl_->features;
}
const std::vector<SceneWarning>& Renderer::warnings() const {
    return impl_->warnings;
}
const PrepareTimes& Renderer::prepareTimes() const {
    return impl_->times;
}
uint64_t Renderer::featureBits() const {
    return impl_->compiled.features;
}
const LightCounts& Renderer::lights() const {
    return impl_->moments.front().scene.lights;
}
uint64_t Renderer::triangleCount() const {
    return impl_->moments.front().scene.triangles;
}
uint64_t Renderer::degenerateTriangles() const {
    return impl_->moments.front().degenerateTriangles;
}

}  // namespace tilefarm
