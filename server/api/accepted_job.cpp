#include "server/api/accepted_job.h"

#include <nlohmann/json.hpp>

#include "server/api/services.h"
#include "shared/error/error.h"
#include "shared/gltf/picture_size.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

// A row of tiles is in memory when an image is written.
constexpr uint64_t kMostTileRowBytes = 1ull << 30;

void requireBlobs(const Services& s, const JobSpec& spec) {
    std::vector<Fault> faults;
    for (const auto& [path, sha256] : spec.scene.files) {
        if (!s.blobs.size(sha256)) {
            faults.push_back(
                {"/scene/files/" + pointerToken(path), "blob " + sha256 + " is not on the server"});
        }
    }
    if (faults.empty()) return;
    const std::string message = std::to_string(faults.size()) + " files of the scene are not on the server";
    throw Error(ErrorCode::unprocessable, message, std::move(faults));
}

// A picture without a size takes the aspect of its camera.
JobSpec sized(const Services& s, JobSpec spec) {
    const std::string& sha256 = spec.scene.files.at(spec.scene.entry);
    const GltfBytes gltf{s.blobs.size(sha256).value_or(0), [&](uint64_t offset, std::span<std::byte> into) {
                             s.blobs.read(sha256, offset, into);
                         }};
    spec.image = pictureSize(gltf, spec);
    return jobFromJson(toJson(spec));  // the rules between members, now that its size is known
}

}  // namespace

void requireModestTiles(const ImageSpec& image) {
    const uint64_t rows = std::min(image.tileSize, image.height);
    if (image.width * rows * sizeof(FilmPixel) <= kMostTileRowBytes) return;
    throw Error(ErrorCode::unprocessable, "the tiles are too large for the image",
                {{"/image/tileSize", "a row of tiles would need more memory than the server gives it"}});
}

JobSpec acceptedJob(const Services& s, JobSpec spec) {
    requireBlobs(s, spec);
    if (spec.image.width == 0 || spec.image.height == 0) spec = sized(s, std::move(spec));
    requireModestTiles(spec.image);
    return spec;
}

}  // namespace tilefarm
