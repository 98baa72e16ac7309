#pragma once

#include <memory>

#include "server/film/frame_images.h"
#include "server/film/result_merger.h"
#include "server/queue/scheduler.h"
#include "server/store/sqlite_job_store.h"
#include "tests/support/fake_clock.h"
#include "tests/support/memory_blob_store.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {

/// A small job: 40 x 24 pixels, six tiles of 16, passes of 1, 1, 2, 4 samples.
inline JobSpec smallJob(uint32_t samples = 8) {
    JobSpec spec;
    spec.scene.files = {{"a.glb", std::string(64, 'a')}};
    spec.scene.entry = "a.glb";
    spec.image = {.width = 40, .height = 24, .tileSize = 16};
    spec.stop.samples = samples;
    return spec;
}

inline WorkerHello hello(const std::string& worker) {
    return {worker, "host", "device", "driver", TILEFARM_VERSION};
}

/// What a renderer would leave: a pure function of pixel and samples, different for each.
PassFilm renderPass(const TileGrid& grid, const LeasedPass& pass, int32_t frame = 0,
                    const FilmLayout& layout = {});
std::vector<PassFilm> renderLease(const Lease& lease);
/// The frame as merged in one go, with no farm.
std::vector<FilmTile> renderFrame(const JobSpec& spec, int32_t frame = 0);

/// Store, scheduler and films over one folder, on a fake clock. `reopen` is what a crash and a
/// restart do.
struct TestFarm {
    TemporaryFolder folder;
    FakeClock clock;
    QueueConfig config;
    FilmStore::Probe probe;
    MemoryBlobStore blobs;
    std::unique_ptr<SqliteJobStore> store;
    std::unique_ptr<Scheduler> scheduler;
    std::unique_ptr<FilmStore> films;
    std::unique_ptr<FrameImages> images;
    std::unique_ptr<ResultMerger> merger;

    explicit TestFarm(QueueConfig c = {}) : config(c) { open(); }
    void open();
    void reopen();

    JobRow job(const std::string& id) const;
    std::shared_ptr<const JobInfo> info(const std::string& id) const;
    FrameRow frame(const std::string& id, int32_t number = 0) const;
    /// Throws std::runtime_error if there is no work.
    Lease lease(const std::string& worker = "w", double seconds = 5);
    std::optional<Lease> tryLease(const std::string& worker = "w", double seconds = 5);
    ResultReceipt deliver(const Lease& lease, const std::vector<PassFilm>& films, double deviceSeconds = 1);
    ResultReceipt deliver(const Lease& lease) { return deliver(lease, renderLease(lease)); }
    /// Renders with one worker until nothing is left, and finishes frames.
    void finish(const std::string& worker = "w");
    /// The film of a frame as far as it is merged.
    std::vector<FilmTile> film(const std::string& id, int32_t frame = 0);
};

bool sameBits(const std::vector<FilmTile>& a, const std::vector<FilmTile>& b);

}  // namespace tilefarm
