#pragma once

#include <filesystem>

#include "server/api/event_bus.h"
#include "server/api/upload_body.h"
#include "server/film/fair_gate.h"
#include "server/film/frame_images.h"
#include "server/film/result_merger.h"
#include "server/queue/scheduler.h"
#include "server/report/metrics.h"
#include "server/store/blob_store.h"
#include "server/study/runner.h"

namespace tilefarm {

struct ApiConfig {
    std::filesystem::path folder;                                            // whose disk is watched
    std::filesystem::path uploads = std::filesystem::temp_directory_path();  // where large ones arrive
    std::string token;                                                       // empty: none asked for
    uint64_t leastFreeBytes = 1ull << 30;  // below, uploads and jobs get 507
    uint64_t mostBlobBytes = 16ull << 30;
    uint64_t mostJsonBytes = 16ull << 20;
};

/// What the resources work with; main wires it.
struct Services {
    ApiConfig config;
    const Clock& clock;
    JobStore& store;
    BlobStore& blobs;
    Scheduler& scheduler;
    ResultMerger& merger;
    FrameImages& images;
    EventBus& events;
    Metrics& metrics;
    StudyRunner& studies;
    MemoryBudget uploadMemory{32u << 20};
    /// Results that are decoded and merged at a time: each is up to 64 MB as sent and again as decoded. One
    /// that still arrives is not among them.
    FairGate decoders{4};

    /// Throws Error(outOfSpace) when the disk has less than the floor and `bytes` left.
    void requireDiskSpace(uint64_t bytes) const;
};

}  // namespace tilefarm
