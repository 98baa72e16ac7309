#include "worker/agent/standing.h"

#include <algorithm>
#include <utility>

namespace tilefarm {

Standing::Standing(std::function<void()> onStop) : onStop_(std::move(onStop)) {}

void Standing::mustStop(const std::string& why) {
    {
        const std::lock_guard lock(mutex_);
        if (stopped_) return;
        stopped_ = why;
    }
    if (onStop_) onStop_();
}

std::optional<std::string> Standing::stopped() const {
    const std::lock_guard lock(mutex_);
    return stopped_;
}

void Standing::holdLeasing(TimePoint until) {
    const std::lock_guard lock(mutex_);
    leasingHeldUntil_ = std::max(leasingHeldUntil_, until);
}

TimePoint Standing::leasingHeldUntil() const {
    const std::lock_guard lock(mutex_);
    return leasingHeldUntil_;
}

void Standing::jobGone(const std::string& jobId) {
    const std::lock_guard lock(mutex_);
    goneJobs_.insert(jobId);
}

bool Standing::isGone(const std::string& jobId) const {
    const std::lock_guard lock(mutex_);
    return goneJobs_.contains(jobId);
}

}  // namespace tilefarm
