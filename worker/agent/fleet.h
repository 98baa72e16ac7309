#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "worker/agent/agent.h"
#include "worker/agent/result_store.h"

namespace tilefarm {

/// One device of this process and the name it goes by on the farm.
struct FleetMember {
    std::string worker;
    /// Called in the thread that will use it.
    std::function<std::unique_ptr<RenderBackend>()> makeBackend;
};

struct FleetParts {
    std::function<std::unique_ptr<Farm>()> makeFarm;  // one for each thread
    BlobCache& cache;
    ResultStore& store;
    StopSwitch& stop;
    const Clock& clock;
    std::string host, version;
    double wantSeconds = 5;
    uint32_t seed = 1;  // of the jitter of waits
};

/// Runs an agent for each member, each with a thread that renders, one that uploads and one that renews,
/// until the switch is thrown or the server sends the worker away. Results that an earlier run left
/// behind are uploaded first. Returns what went wrong: why the server sent it away, which devices could
/// not be used.
std::vector<std::string> runFleet(const FleetParts& parts, const std::vector<FleetMember>& members);

}  // namespace tilefarm
