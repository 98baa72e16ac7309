#include "worker/local/render_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "shared/denoise/exr_denoise.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/film/notices.h"
#include "shared/gltf/picture_size.h"
#include "shared/image/png.h"
#include "shared/job/numbered.h"
#include "shared/job/wire.h"
#include "shared/matte/scene_names.h"
#include "worker/local/local_report.h"
#include "worker/local/scene_bundle.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

void requireFolderOf(const fs::path& file) {
    if (file.empty()) return;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!fs::is_directory(folder) || access(folder.c_str(), W_OK) != 0)
        throw Error(ErrorCode::notFound, fmt::format("cannot write {}: {} is no folder to write in",
                                                     file.string(), folder.string()));
}

std::string timeText(double seconds) {
    const auto whole = static_cast<uint64_t>(seconds + 0.5);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

std::string lineFor(const FrameProgress& p) {
    const double share = static_cast<double>(p.samplesDone) / static_cast<double>(p.samplesInAll);
    std::string line = fmt::format("{:5.1f} %  {} samples", 100 * share, p.last.samples);
    if (p.last.relativeError) line += fmt::format("  relative error {:.4f}", *p.last.relativeError);
    line += fmt::format("  {} elapsed", timeText(p.seconds));
    if (p.samplesDone < p.samplesInAll) line += fmt::format(", {} left", timeText(p.secondsLeft));
    return line;
}

class ProgressLine {
public:
    explicit ProgressLine(std::FILE* out) : out_(out), terminal_(isatty(fileno(out)) != 0) {}
    void show(const FrameProgress& progress) {
        const bool last = progress.samplesDone == progress.samplesInAll;
        if (terminal_)
            fmt::print(out_, "\r{}\033[K{}", lineFor(progress), last ? "\n" : "");
        else if (progress.wholeLevel)
            fmt::print(out_, "{}\n", lineFor(progress));
        std::fflush(out_);
    }

private:
    std::FILE* out_;
    bool terminal_;
};

FloatImage colourOf(const ImageSpec& image, const std::vector<FilmTile>& tiles) {
    FloatImage picture{image.width, image.height, {"R", "G", "B"}, {}};
    picture.planes.assign(3, std::vector<float>(picture.pixelCount()));
    for (const FilmTile& tile : tiles)
        for (uint32_t i = 0; i < tile.pixels.size(); ++i) {
            const uint32_t x = tile.rect.x + i % tile.rect.width, y = tile.rect.y + i / tile.rect.width;
            for (size_t c = 0; c < 3; ++c)
                picture.planes[c][size_t{y} * image.width + x] = static_cast<float>(tile.pixels[i].mean[c]);
        }
    return picture;
}

std::string text(const glm::vec3& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

std::string placeOf(const TraceStep& s) {
    if (std::isinf(s.t)) return fmt::format("left the scene towards {}", text(s.position));
    if (s.primitive == kNone) return fmt::format("fog at {} after {:.6g}", text(s.position), s.t);
    return fmt::format("primitive {} at {} after {:.6g}", s.primitive, text(s.position), s.t);
}

void showSample(const DroppedSample& at, const SampleTrace& trace, std::FILE* out) {
    fmt::print(out, "pixel {},{} sample {}: radiance {}\n", at.x, at.y, at.sample, text(trace.radiance));
    for (size_t i = 0; i < trace.steps.size(); ++i) {
        const TraceStep& s = trace.steps[i];
        fmt::print(out, "  {:>3}  {}  throughput {}  pdf {:.6g}  radiance so far {}\n", i, placeOf(s),
                   text(s.throughput), s.pdf, text(s.radiance));
    }
}

MatteMetadata mattesOf(const JobSpec& spec, const fs::path& gltf) {
    if (!spec.output.cryptomatte) return {};
    return matteMetadata(bytesOfGltf(readWhole(gltf)), spec);
}

fs::path fileFor(const fs::path& path, const JobSpec& spec, int32_t frame) {
    return spec.frames.count > 1 && !path.empty() ? numbered(path, frame) : path;
}

void renderOne(const LocalRender& render, JobSpec spec, int32_t number, RenderBackend& device,
               const PreparedScene& scene, const Clock& clock, std::FILE* progress) {
    const fs::path exr = fileFor(render.exr, spec, number), png = fileFor(render.png, spec, number),
                   report = fileFor(render.report, spec, number);
    if (spec.frames.count > 1) fmt::print(progress, "frame {}\n", number);
    spec.frames = {.first = number};
    ProgressLine line(progress);
    const RenderedFrame frame =
        renderFrame(device, spec, number, clock, [&](const FrameProgress& p) { line.show(p); });
    if (spec.stop.decidesOnTheWay())
        fmt::print(progress, "{}\n",
                   sentenceOf(frame.stopReason, spec.stop, frame.errorCurve.back().samples));
    if (frame.stats.droppedSamples > 0)
        fmt::print(progress, "warning: {} samples were NaN or infinite and were dropped\n",
                   frame.stats.droppedSamples);
    for (const DroppedSample& s : frame.stats.faults.dropped)
        fmt::print(progress, "    to print its path: --pixel {},{} --sample {}\n", s.x, s.y, s.sample);
    for (const std::string& notice : noticesOf(frame.stats.faults, frame.stats.samples))
        fmt::print(progress, "note: {}\n", notice);
    const MatteMetadata mattes = mattesOf(spec, render.files.entry);
    writeFrameExr(exr, spec.image, [&](uint32_t tile) { return frame.tiles[tile]; },
                  localAttributes(spec, device.device(), frame), {filmLayoutOf(spec), mattes.header});
    for (const auto& [name, text] : mattes.sidecars) writeDurably(exr.parent_path() / name, text);
    if (spec.output.denoise) denoiseExr(exr, exr, {.wrap = spec.view.kind == ViewKind::panorama});
    if (!png.empty()) writePng(png, toneMapped(colourOf(spec.image, frame.tiles), render.tone));
    if (!report.empty())
        writeDurably(report, localReport(spec, device.device(), scene, frame).dump(2) + "\n");
}

}  // namespace

void requireValid(const LocalRender& render) {
    JobSpec checked = render.spec;
    // The scene's files are looked at later.
    const std::string anyDigest(64, '0'), environment = render.files.environment.empty() ? "" : "sky.hdr";
    checked.scene = {"scene.gltf", {{"scene.gltf", anyDigest}, {"sky.hdr", anyDigest}}, environment};
    jobFromJson(toJson(checked));
}

void runLocalRender(const LocalRender& render, const std::function<std::unique_ptr<RenderBackend>()>& backend,
                    const Clock& clock, std::FILE* progress, std::FILE* samples) {
    requireValid(render);
    for (const fs::path& output : {render.exr, render.png, render.report}) requireFolderOf(output);
    JobSpec spec = render.spec;
    spec.scene = bundleOf(render.files, spec.strict);
    spec.image = pictureSize(bytesOfGltf(readWhole(render.files.entry)), spec);
    spec = jobFromJson(toJson(spec));  // the rules between members, now that its size is known

    const auto device = backend();
    const PreparedScene scene = device->prepare(spec, render.files);
    for (const SceneWarning& w : scene.warnings)
        fmt::print(progress, "warning: {}: {}: {}\n", w.where, w.feature, w.instead);
    if (const auto& at = render.pixel)
        return showSample(*at, device->trace(spec.frames.first, at->x, at->y, at->sample), samples);
    for (const int32_t frame : frameNumbers(spec.frames))
        renderOne(render, spec, frame, *device, scene, clock, progress);
}

}  // namespace tilefarm
