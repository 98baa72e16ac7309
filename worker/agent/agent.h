#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "worker/agent/actions.h"
#include "worker/agent/backoff.h"
#include "worker/agent/lease_keeper.h"
#include "worker/agent/pause.h"
#include "worker/agent/result_queue.h"
#include "worker/blob_cache/blob_cache.h"

namespace tilefarm {

/// The loop of one device: asks for work, makes the scene resident, renders the passes of the lease in
/// few dispatches and passes the films on to the Uploader. What each fault of the server means is in
/// actions.h.
class Agent {
public:
    struct Parts {
        Farm& farm;
        RenderBackend& backend;
        BlobCache& cache;
        LeaseKeeper& keeper;
        ResultQueue& results;
        Standing& standing;
        Pause& pause;
        const Clock& clock;
    };
    Agent(Parts parts, WorkerHello hello, double wantSeconds, uint32_t seed);

    /// Until the worker is told to stop, by a person or by the server. A lease that is not done then
    /// goes back, with what is rendered of it uploaded.
    void run();
    /// Asks for work once, and does it or waits.
    void step();

private:
    std::optional<Lease> askForWork();
    void work(const Lease& lease, const std::shared_ptr<HeldLease>& held);
    void makeResident(const Lease& lease, const HeldLease& held);
    PreparedScene prepare(const Lease& lease, const HeldLease& held);
    void reportScene(const Lease& lease);
    std::vector<PassFilm> renderPasses(const Lease& lease, const HeldLease& held);
    void finish(const Lease& lease, const std::shared_ptr<HeldLease>& held, std::vector<PassFilm> films,
                double deviceSeconds);
    void handBack(const HeldLease& held);
    void reportFailure(const HeldLease& held, const std::string& message);
    void letGo();
    bool mayGoOn(const HeldLease& held) const;

    Parts with_;
    WorkerHello hello_;
    double wantSeconds_;
    Backoff away_;      // while the server does not answer as it should
    Backoff failures_;  // after leases that could not be rendered
    std::string residentKey_, residentJob_;
    PreparedScene resident_;
    std::set<std::string> reportedJobs_;
};

/// Text equal for two jobs if one's resident scene, camera and kernel serve the other.
std::string residentKey(const JobSpec& spec);

}  // namespace tilefarm
