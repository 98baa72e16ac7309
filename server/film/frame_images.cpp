#include "server/film/frame_images.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "server/film/picture.h"
#include "shared/denoise/exr_denoise.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/image/png.h"
#include "shared/job/job.h"
#include "shared/job/wire.h"
#include "shared/matte/scene_names.h"

namespace tilefarm {

namespace fs = std::filesystem;

namespace {

constexpr size_t kPicturesKept = 24;
constexpr int kMostOfOneCore = 25;  // an image of a frame in work is made again after 25 times its cost

std::string join(const std::set<std::string>& words) {
    std::string joined;
    for (const std::string& word : words) joined += (joined.empty() ? "" : "; ") + word;
    return joined;
}

// One core is left to those who ask for pictures and bring results. How many there are decides no bit.
uint32_t denoiserThreads() {
    return std::max(1u, std::thread::hardware_concurrency() - 1);
}

void requireDenoised(bool wanted, const JobSpec& spec, const FrameRow& row) {
    if (!wanted) return;
    const std::string name = "frame " + std::to_string(row.frame);
    if (!spec.output.denoise)
        throw Error(ErrorCode::conflict,
                    name + " has no denoised picture: its job does not ask for output.denoise");
    if (row.state != FrameState::completed)
        throw Error(ErrorCode::conflict, name + " has no denoised picture until it is complete");
}

}  // namespace

FrameImages::FrameImages(JobStore& store, Scheduler& scheduler, FilmStore& films, const BlobStore& blobs,
                         const Clock& clock, fs::path folder)
    : store_(store),
      scheduler_(scheduler),
      films_(films),
      blobs_(blobs),
      clock_(clock),
      folder_(std::move(folder)) {
    fs::remove_all(folder_ / "cache");
    makeFolder(folder_ / "cache");
    makeFolder(folder_ / "images");
}

FrameImages::Frame FrameImages::find(const std::string& jobId, int32_t number) const {
    Frame frame;
    store_.read([&](const ConstTables& t) {
        const auto job = t.jobs.find(jobId);
        if (!job) throw Error(ErrorCode::notFound, "there is no job '" + jobId + "'");
        frame.info = scheduler_.catalog().get(t, *job);
        const std::string name = "frame " + std::to_string(number) + " of job '" + jobId + "'";
        if (!frame.info->hasFrame(number)) throw Error(ErrorCode::notFound, "there is no " + name);
        const auto row = t.frames.find(job->key, number);
        if (!row) throw Error(ErrorCode::notFound, name + " has not begun");
        frame.job = *job;
        frame.row = *row;
    });
    return frame;
}

// The tile's row is read under its lock: a merge may have flipped the slots since.
FilmTile FrameImages::tile(const Frame& frame, uint32_t index) const {
    const TileLocks::Hold hold(films_.locks(), frame.job.key, frame.row.frame, {index});
    std::optional<TileRow> row;
    store_.read([&](const ConstTables& t) { row = t.frames.tile(frame.job.key, frame.row.frame, index); });
    if (!row) throw Error(ErrorCode::conflict, "the frame was completed meanwhile");
    return films_.read(*frame.info, frame.row.frame, *row);
}

// A scene's names are those of all its frames.
MatteMetadata FrameImages::mattes(const std::string& jobId, const JobSpec& spec) {
    if (!spec.output.cryptomatte) return {};
    const std::scoped_lock lock(naming_);
    if (lastMattes_.first != jobId) {
        const std::string& sha256 = spec.scene.files.at(spec.scene.entry);
        const GltfBytes gltf{
            blobs_.size(sha256).value_or(0),
            [&](uint64_t offset, std::span<std::byte> into) { blobs_.read(sha256, offset, into); }};
        lastMattes_ = {jobId, matteMetadata(gltf, spec)};
    }
    return lastMattes_.second;
}

std::string FrameImages::sidecar(const std::string& jobId, const std::string& file) {
    std::shared_ptr<const JobInfo> info;
    store_.read([&](const ConstTables& t) {
        if (const auto job = t.jobs.find(jobId)) info = scheduler_.catalog().get(t, *job);
    });
    if (!info) throw Error(ErrorCode::notFound, "there is no job '" + jobId + "'");
    const MatteMetadata metadata = mattes(jobId, info->spec);
    const auto found = metadata.sidecars.find(file);
    if (found == metadata.sidecars.end())
        throw Error(ErrorCode::notFound, "no picture of job '" + jobId + "' names a file '" + file + "'");
    return found->second;
}

void FrameImages::write(const fs::path& path, const Frame& frame) {
    const JobSpec& spec = frame.info->spec;
    writeFrameExr(path, spec.image, [&](uint32_t i) { return tile(frame, i); }, attributes(frame),
                  {filmLayoutOf(spec), mattes(frame.job.id, spec).header});
}

ImageAttributes FrameImages::attributes(const Frame& frame) const {
    std::set<std::string> devices, drivers;
    std::string text;
    store_.read([&](const ConstTables& t) {
        text = t.jobs.spec(frame.job.key);
        std::set<std::string> names;
        for (const ContributionRow& row : t.workers.contributions(frame.job.key)) names.insert(row.worker);
        for (const WorkerRow& worker : t.workers.list()) {
            if (!names.contains(worker.hello.worker)) continue;
            devices.insert(worker.hello.device);
            drivers.insert(worker.hello.driver);
        }
    });
    const auto spec = nlohmann::json::parse(text);
    return {{"job", frame.job.id},
            {"frame", std::to_string(frame.row.frame)},
            {"scene", sha256Hex(spec.at("scene").dump())},
            {"settings", spec.dump()},
            {"samples", std::to_string(frame.row.samplesMerged)},
            {"devices", join(devices)},
            {"drivers", join(drivers)},
            {"deviceSeconds", std::to_string(frame.row.deviceSeconds)},
            {"droppedSamples", std::to_string(frame.row.droppedSamples)},
            {"relativeError", frame.row.relativeError ? std::to_string(*frame.row.relativeError) : ""},
            {"renderer", std::string("Tilefarm ") + TILEFARM_VERSION},
            {"state", frame.row.state == FrameState::active ? "partial" : "complete"},
            {"stopped", stopSentence(frame.row, frame.info->spec.stop)}};
}

fs::path FrameImages::finalPath(const Frame& frame) const {
    return folder_ / "images" / frame.job.id / (std::to_string(frame.row.frame) + ".exr");
}

ImageFile FrameImages::finalExr(const Frame& frame) const {
    auto file = std::make_shared<File>(finalPath(frame), File::Mode::read);
    return {std::move(file), frame.row.exrBytes, frame.row.exrSha256, false};
}

bool FrameImages::freshEnough(const Made& made, const FrameRow& row) const {
    return made.revision == row.revision || clock_.now() - made.at < kMostOfOneCore * made.cost;
}

ImageFile FrameImages::exr(const std::string& jobId, int32_t number) {
    const Frame frame = find(jobId, number);
    if (frame.row.state == FrameState::completed) return finalExr(frame);
    try {
        return partialExr(frame);
    } catch (const Error&) {  // completed while it was being written?
        const Frame again = find(jobId, number);
        if (again.row.state != FrameState::completed) throw;
        return finalExr(again);
    }
}

std::optional<ImageFile> FrameImages::keptExr(const std::string& name, const FrameRow& row) {
    const std::scoped_lock lock(keeping_);
    const auto at = partial_.find(name);
    if (at == partial_.end() || !freshEnough(at->second.first, row)) return std::nullopt;
    return at->second.second;
}

ImageFile FrameImages::partialExr(const Frame& frame) {
    const std::string name = frame.job.id + "-" + std::to_string(frame.row.frame) + ".exr";
    const KeyedLocks::Hold one(makers_, name);
    if (const auto kept = keptExr(name, frame.row)) return *kept;
    const FairGate::Pass pass(exrWriters_);
    const TimePoint begin = clock_.now();
    const fs::path path = folder_ / "cache" / name;
    write(path, frame);
    auto file = std::make_shared<File>(path, File::Mode::read);
    const ImageFile image{file, file->size(), sha256OfFile(path), true};
    fs::remove(path);  // lives on while somebody holds it open
    const std::scoped_lock lock(keeping_);
    if (partial_.size() >= kPicturesKept) partial_.clear();
    partial_[name] = {{frame.row.revision, clock_.now(), clock_.now() - begin}, image};
    return image;
}

std::optional<Picture> FrameImages::keptPicture(const std::string& key, const FrameRow& row) {
    const std::scoped_lock lock(keeping_);
    const bool partial = row.state != FrameState::completed;
    const auto at = pictures_.find(key);
    if (at == pictures_.end() || at->second.second.partial != partial ||
        (partial && !freshEnough(at->second.first, row)))
        return std::nullopt;
    return at->second.second;
}

Picture FrameImages::png(const std::string& jobId, int32_t number, const ToneMapping& mapping, uint32_t width,
                         bool denoised) {
    const Frame frame = find(jobId, number);
    requireDenoised(denoised, frame.info->spec, frame.row);
    const std::string key = jobId + "/" + std::to_string(number) + "/" + std::to_string(mapping.exposure) +
                            "/" + std::string(toString(mapping.curve)) + "/" + std::to_string(width) +
                            (denoised ? "/denoised" : "");
    const KeyedLocks::Hold one(makers_, key);
    if (const auto kept = keptPicture(key, frame.row)) return *kept;
    const FairGate::Pass pass(painters_);
    const TimePoint begin = clock_.now();
    const Picture picture = paint(frame, mapping, width, denoised);
    const std::scoped_lock lock(keeping_);
    if (pictures_.size() >= kPicturesKept) pictures_.clear();
    pictures_[key] = {{frame.row.revision, clock_.now(), clock_.now() - begin}, picture};
    return picture;
}

// Of a frame that may be completed, and its film removed, while it is read.
Picture FrameImages::paint(const Frame& frame, const ToneMapping& mapping, uint32_t width, bool denoised) {
    try {
        return makePng(frame, mapping, width, denoised);
    } catch (const Error&) {
        const Frame again = find(frame.job.id, frame.row.frame);
        if (frame.row.state == FrameState::completed || again.row.state != FrameState::completed) throw;
        return makePng(again, mapping, width, denoised);
    }
}

Picture FrameImages::makePng(const Frame& frame, const ToneMapping& mapping, uint32_t width, bool denoised) {
    const ImageSpec& image = frame.info->spec.image;
    const bool partial = frame.row.state != FrameState::completed;
    PictureBuilder builder(image.width, image.height, width == 0 ? image.width : width, mapping);
    if (partial) {
        for (uint32_t i = 0; i < frame.info->grid.count(); ++i) builder.add(tile(frame, i));
    } else {
        forEachRows(finalPath(frame), denoised ? "denoised" : "",
                    [&](uint32_t y, auto pixels) { builder.addRows(y, pixels); });
    }
    auto png = std::make_shared<const std::vector<std::byte>>(encodePng(builder.finish()));
    return {png, sha256Hex(*png), partial};
}

std::vector<std::string> FrameImages::finishFrames() {
    std::vector<Frame> ready;
    store_.read([&](const ConstTables& t) {
        for (const FrameRow& row : t.frames.listByState(FrameState::finishing)) {
            const JobRow job = *t.jobs.find(row.job);
            ready.push_back({job, row, scheduler_.catalog().get(t, job)});
        }
    });
    std::vector<std::string> faults;
    for (const Frame& frame : ready) {
        try {
            finish(frame);
        } catch (const Error& fault) {
            faults.emplace_back(fault.what());
        }
    }
    return faults;
}

// A denoised frame is written raw first: the denoiser reads bands of it, and the rest of the file as it is.
void FrameImages::writeFinal(const Frame& frame, const fs::path& path) {
    const JobSpec& spec = frame.info->spec;
    const std::string name = frame.job.id + "-" + std::to_string(frame.row.frame) + "-raw.exr";
    const fs::path raw = spec.output.denoise ? folder_ / "cache" / name : path;
    write(raw, frame);
    if (!spec.output.denoise) return;
    denoiseExr(raw, path, {.wrap = spec.view.kind == ViewKind::panorama, .threads = denoiserThreads()});
    fs::remove(raw);
}

void FrameImages::finish(const Frame& frame) {
    const fs::path path = finalPath(frame);
    makeFolder(path.parent_path());
    writeFinal(frame, path);
    films_.reached("image written");
    scheduler_.frameWritten(frame.job.key, frame.row.frame, sha256OfFile(path), fs::file_size(path));
    films_.reached("frame completed");
    films_.remove(*frame.info, frame.row.frame);
}

void FrameImages::removeSpentFilms() {
    std::vector<Frame> spent;
    store_.read([&](const ConstTables& t) {
        for (const FrameRow& row : t.frames.listByState(FrameState::completed)) {
            const auto job = *t.jobs.find(row.job);
            if (fs::exists(folder_ / "films" / job.id))
                spent.push_back({job, row, scheduler_.catalog().get(t, job)});
        }
    });
    for (const Frame& frame : spent) films_.remove(*frame.info, frame.row.frame);
}

}  // namespace tilefarm
