#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/job/job.h"
#include "shared/job/leased_pass.h"
#include "shared/job/worker_hello.h"

namespace tilefarm {

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
