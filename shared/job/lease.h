#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/job/job.h"
#include "shared/job/pass_schedule.h"

namespace tilefarm {

/// One pass of one tile on loan.
struct LeasedPass {
    uint32_t tile = 0;  // index in the job's TileGrid
    SampleRange samples;
    friend bool operator==(const LeasedPass&, const LeasedPass&) = default;
};

/// What a worker says of itself when it asks for work.
struct WorkerHello {
    std::string worker;     // stable id, unique per process and device
    std::string host;       // for people
    std::string device;     // Vulkan device name
    std::string driver;     // driver name and version
    std::string version;    // TILEFARM_VERSION
    std::string session{};  // its process, the same for all of its devices; empty: the worker itself
    /// Sessions on this machine that were killed or crashed: their leases are lost at once.
    std::vector<std::string> ended{};
    friend bool operator==(const WorkerHello&, const WorkerHello&) = default;
};

/// Passes of one frame of one job on loan to one worker until a deadline.
struct Lease {
    std::string id;
    uint64_t epoch = 0;  // grows with every grant of the farm
    std::string jobId;
    JobSpec spec;
    int32_t frame = 0;
    std::vector<LeasedPass> passes;  // by first sample, then tile
    uint32_t expiresInMs = 30000;    // from the answer; renewing starts it anew
    uint32_t renewEveryMs = 10000;
    friend bool operator==(const Lease&, const Lease&) = default;
};

/// What the server made of each pass of an uploaded result.
struct ResultReceipt {
    uint32_t merged = 0;         // counted now
    uint32_t alreadyMerged = 0;  // counted before; these bits changed nothing
    friend bool operator==(const ResultReceipt&, const ResultReceipt&) = default;
};

}  // namespace tilefarm
