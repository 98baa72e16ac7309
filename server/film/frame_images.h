#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/film/fair_gate.h"
#include "server/film/film_store.h"
#include "server/film/keyed_locks.h"
#include "server/queue/scheduler.h"
#include "server/store/blob_store.h"
#include "shared/image/exr.h"
#include "shared/image/tone.h"
#include "shared/matte/cryptomatte.h"

namespace tilefarm {

struct JobSpec;

/// An open image file with the digest of its bytes; stays readable when a newer one replaces it.
struct ImageFile {
    std::shared_ptr<const File> file;
    uint64_t bytes = 0;
    std::string sha256;
    bool partial = false;
};

struct Picture {
    std::shared_ptr<const std::vector<std::byte>> png;
    std::string sha256;
    bool partial = false;
};

/// Images of frames, finished or as far as they are merged. One EXR and a few pictures are made at a time, a
/// row of tiles in memory for each; what was asked for twice is made once. A picture of a frame in work may
/// be a little older than its film: making it again is bounded to a few per cent of one core.
class FrameImages {
public:
    /// `blobs`: where the scenes' files are, for the names in their mattes.
    FrameImages(JobStore& store, Scheduler& scheduler, FilmStore& films, const BlobStore& blobs,
                const Clock& clock, std::filesystem::path folder);

    /// Throw Error(notFound) for an unknown job, or a frame without a film yet.
    ImageFile exr(const std::string& jobId, int32_t frame);
    /// `width` 0: that of the frame. Throws Error(conflict) for a denoised picture that the frame does not
    /// have, or not yet.
    Picture png(const std::string& jobId, int32_t frame, const ToneMapping& mapping, uint32_t width,
                bool denoised = false);

    /// A file that the header of the job's EXRs names: the manifest of a matte. Throws Error(notFound) for an
    /// unknown job, and where its EXRs name no such file.
    std::string sidecar(const std::string& jobId, const std::string& file);

    /// Writes the final image of each frame whose passes are all merged, marks it completed, and
    /// removes its film. Frames whose writing fails stay as they are; gives their faults.
    std::vector<std::string> finishFrames();
    /// Films of frames that are completed: a crash may have left them.
    void removeSpentFilms();

private:
    struct Frame {
        JobRow job;
        FrameRow row;
        std::shared_ptr<const JobInfo> info;
    };
    struct Made {
        uint64_t revision = 0;
        TimePoint at{};
        Milliseconds cost{};
    };

    Frame find(const std::string& jobId, int32_t frame) const;
    FilmTile tile(const Frame& frame, uint32_t index) const;
    MatteMetadata mattes(const std::string& jobId, const JobSpec& spec);
    void write(const std::filesystem::path& path, const Frame& frame);
    ImageAttributes attributes(const Frame& frame) const;
    std::filesystem::path finalPath(const Frame& frame) const;
    ImageFile finalExr(const Frame& frame) const;
    ImageFile partialExr(const Frame& frame);
    Picture makePng(const Frame& frame, const ToneMapping& mapping, uint32_t width, bool denoised);
    Picture paint(const Frame& frame, const ToneMapping& mapping, uint32_t width, bool denoised);
    bool freshEnough(const Made& made, const FrameRow& row) const;
    std::optional<ImageFile> keptExr(const std::string& name, const FrameRow& row);
    std::optional<Picture> keptPicture(const std::string& key, const FrameRow& row);
    void finish(const Frame& frame);
    void writeFinal(const Frame& frame, const std::filesystem::path& path);

    JobStore& store_;
    Scheduler& scheduler_;
    FilmStore& films_;
    const BlobStore& blobs_;
    const Clock& clock_;
    std::filesystem::path folder_;

    KeyedLocks makers_;  // of each image, one
    // Both bound memory. A large EXR takes a minute, for which pictures do not wait.
    FairGate exrWriters_{1}, painters_{2};
    std::mutex naming_;                                 // guards the next line
    std::pair<std::string, MatteMetadata> lastMattes_;  // by the job's id
    std::mutex keeping_;                                // guards what follows
    std::map<std::string, std::pair<Made, ImageFile>> partial_;
    std::map<std::string, std::pair<Made, Picture>> pictures_;
};

}  // namespace tilefarm
