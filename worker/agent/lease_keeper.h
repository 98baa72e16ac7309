#pragma once

#include <atomic>
#include <condition_variable>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "shared/clock/clock.h"
#include "worker/agent/farm.h"
#include "worker/agent/standing.h"

namespace tilefarm {

/// Whether the server still counts with a lease.
enum class LeaseValidity {
    valid,
    lost,     // the server counts without it; what is rendered already may still be of use
    jobGone,  // its job is gone
};

/// A lease as the threads of a worker share it.
struct HeldLease {
    explicit HeldLease(const Lease& lease)
        : id(lease.id), epoch(lease.epoch), jobId(lease.jobId), renewEvery(lease.renewEveryMs) {}
    const std::string id;
    const uint64_t epoch;
    const std::string jobId;
    const Milliseconds renewEvery;
    std::atomic<LeaseValidity> state = LeaseValidity::valid;
};

/// Renews leases from the grant until the server has their results. Any thread may call, but only one
/// the two that talk to the server, renewDue() and run().
class LeaseKeeper {
public:
    LeaseKeeper(Farm& farm, Standing& standing, const Clock& clock);

    std::shared_ptr<HeldLease> hold(const Lease& lease);
    void release(const HeldLease& lease);

    /// Renews every lease that is due and notes what the server says of it. Returns how long nothing
    /// is due.
    Milliseconds renewDue();
    /// Renews until end().
    void run();
    void end();

private:
    struct Kept {
        std::shared_ptr<HeldLease> lease;
        TimePoint due;
    };
    std::shared_ptr<HeldLease> nextDue(TimePoint now);
    void renew(HeldLease& lease);

    Farm& farm_;
    Standing& standing_;
    const Clock& clock_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::list<Kept> kept_;
    uint64_t changes_ = 0;
    bool ended_ = false;
};

}  // namespace tilefarm
