#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "shared/clock/clock.h"

namespace tilefarm {

/// What the server has told one worker, for all its threads: whether it must stop, whether it should
/// ask for no work for a while, and which jobs are gone. Any thread may call.
class Standing {
public:
    /// `onStop` is called once, when the worker must stop.
    explicit Standing(std::function<void()> onStop = {});

    void mustStop(const std::string& why);
    /// Why it must stop, if so.
    std::optional<std::string> stopped() const;

    void holdLeasing(TimePoint until);
    TimePoint leasingHeldUntil() const;

    void jobGone(const std::string& jobId);
    bool isGone(const std::string& jobId) const;

private:
    mutable std::mutex mutex_;
    std::function<void()> onStop_;
    std::optional<std::string> stopped_;
    TimePoint leasingHeldUntil_{};
    std::set<std::string> goneJobs_;
};

}  // namespace tilefarm
