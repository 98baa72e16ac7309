#include "shared/job/wire.h"

#include <fmt/format.h>

#include <limits>

#include "shared/job/fields.h"
#include "shared/job/pass_schedule.h"
#include "shared/job/safe_path.h"

namespace tilefarm {

namespace {

using nlohmann::json;

// Rules between members. What already has a fault of its own is not judged again.

void checkScenePath(const SceneBundle& scene, const std::string& path, const std::string& pointer,
                    std::pair<const char*, const char*> suffixes, Faults& faults) {
    if (path.empty() || faults.at(pointer)) return;
    if (!hasSuffix(path, suffixes.first) && !hasSuffix(path, suffixes.second))
        faults.add(pointer, fmt::format("must end with {} or {}", suffixes.first, suffixes.second));
    if (!scene.files.empty() && !scene.files.contains(path))
        faults.add(pointer, "names '" + path + "', which is not among /scene/files");
}

void checkFrames(const FrameRange& frames, Faults& faults) {
    const int64_t last = int64_t{frames.first} + frames.count - 1;
    if (!faults.at("/frames") && last > std::numeric_limits<int32_t>::max())
        faults.add("/frames/count", fmt::format("makes the last frame {}, above {}", last,
                                                std::numeric_limits<int32_t>::max()));
}

void checkTiles(const ImageSpec& image, Faults& faults) {
    if (faults.at("/image")) return;
    if (const uint32_t tiles = TileGrid(image).count(); tiles > kMostTilesPerFrame)
        faults.add("/image/tileSize", fmt::format("cuts {}x{} pixels into {} tiles, more than {}",
                                                  image.width, image.height, tiles, kMostTilesPerFrame));
}

void checkJob(const JobSpec& job, Faults& faults) {
    checkScenePath(job.scene, job.scene.entry, "/scene/entry", {".gltf", ".glb"}, faults);
    checkScenePath(job.scene, job.scene.environment, "/scene/environment", {".hdr", ".exr"}, faults);
    checkFrames(job.frames, faults);
    checkTiles(job.image, faults);
}

template <typename T>
T readAll(const json& source, const char* what, JsonReader::Unknown unknown = JsonReader::Unknown::fault) {
    Faults faults;
    T value;
    JsonReader::read(source, "", faults, value, unknown);
    if constexpr (std::same_as<T, JobSpec>) checkJob(value, faults);
    faults.throwIfAny(ErrorCode::invalidArgument, what);
    return value;
}

}  // namespace

JobSpec jobFromJson(const json& source) {
    return readAll<JobSpec>(source, "the job");
}
json toJson(const JobSpec& spec) {
    return JsonWriter::write(spec);
}
json jobSchema() {
    return JsonSchema::schemaOf(JobSpec{});
}

Lease leaseFromJson(const json& source) {
    Lease lease = readAll<Lease>(source, "the lease");
    // The job within a lease obeys the same rules as one that is submitted, paths above all.
    lease.spec = jobFromJson(source.at("spec"));
    const uint32_t tiles = TileGrid(lease.spec.image).count();
    for (const LeasedPass& pass : lease.passes)
        if (pass.tile >= tiles)
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("the lease: tile {} of an image of {} tiles", pass.tile, tiles));
    return lease;
}
json toJson(const Lease& lease) {
    return JsonWriter::write(lease);
}

// A worker of another version may say more; it is to hear 426, not that a member is unknown.
WorkerHello helloFromJson(const json& source) {
    return readAll<WorkerHello>(source, "the worker's hello", JsonReader::Unknown::ignore);
}
json toJson(const WorkerHello& hello) {
    return JsonWriter::write(hello);
}

ResultReceipt receiptFromJson(const json& source) {
    return readAll<ResultReceipt>(source, "the receipt");
}
json toJson(const ResultReceipt& receipt) {
    return JsonWriter::write(receipt);
}

}  // namespace tilefarm
