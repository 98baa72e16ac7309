#include "worker/agent/lease_keeper.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "worker/agent/actions.h"

namespace tilefarm {
namespace {

// An idle keeper looks up this often; anything that happens wakes it.
constexpr Milliseconds kIdle{60'000};
// While the server is away a renewal is tried at least this often, to be early once it is back.
constexpr Milliseconds kRetry{2'000};

}  // namespace

LeaseKeeper::LeaseKeeper(Farm& farm, Standing& standing, const Clock& clock)
    : farm_(farm), standing_(standing), clock_(clock) {}

std::shared_ptr<HeldLease> LeaseKeeper::hold(const Lease& lease) {
    auto held = std::make_shared<HeldLease>(lease);
    const std::lock_guard lock(mutex_);
    kept_.push_back({held, clock_.now() + held->renewEvery});
    ++changes_;
    changed_.notify_all();
    return held;
}

void LeaseKeeper::release(const HeldLease& lease) {
    const std::lock_guard lock(mutex_);
    kept_.remove_if([&](const Kept& kept) { return kept.lease.get() == &lease; });
}

// The next lease to renew now, if any; its following renewal is set.
std::shared_ptr<HeldLease> LeaseKeeper::nextDue(TimePoint now) {
    const std::lock_guard lock(mutex_);
    for (Kept& kept : kept_)
        if (kept.due <= now) {
            kept.due = now + std::max(kept.lease->renewEvery, Milliseconds(1));
            return kept.lease;
        }
    return nullptr;
}

Milliseconds LeaseKeeper::renewDue() {
    const TimePoint now = clock_.now();
    while (const auto lease = nextDue(now)) renew(*lease);
    const std::lock_guard lock(mutex_);
    Milliseconds wait = kIdle;
    for (const Kept& kept : kept_) wait = std::min(wait, kept.due - clock_.now());
    return std::max(wait, Milliseconds(0));
}

void LeaseKeeper::renew(HeldLease& lease) {
    try {
        farm_.renew(lease.id, lease.epoch);
    } catch (const Error& error) {
        switch (actionFor(Endpoint::renew, error.code)) {
            case Action::stop: standing_.mustStop(error.what()); return;
            case Action::dropJob:
                spdlog::info("job {} is no longer wanted: {}", lease.jobId, error.what());
                standing_.jobGone(lease.jobId);
                lease.state = LeaseValidity::jobGone;
                release(lease);
                return;
            case Action::dropLease:
            case Action::refused:
                spdlog::warn("lost lease {}: {}", lease.id, error.what());
                lease.state = LeaseValidity::lost;
                release(lease);
                return;
            case Action::retry:
            case Action::retryFew:
            case Action::hold: break;
        }
        const std::lock_guard lock(mutex_);
        for (Kept& kept : kept_)
            if (kept.lease.get() == &lease) kept.due = clock_.now() + std::min(lease.renewEvery, kRetry);
    }
}

void LeaseKeeper::run() {
    uint64_t seen = 0;
    while (true) {
        const Milliseconds wait = renewDue();
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, wait, [&] { return ended_ || changes_ != seen; });
        seen = changes_;
        if (ended_) return;
    }
}

void LeaseKeeper::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
}

}  // namespace tilefarm
