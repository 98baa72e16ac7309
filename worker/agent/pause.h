#pragma once

#include <condition_variable>
#include <mutex>

#include "shared/clock/clock.h"

namespace tilefarm {

/// How the parts of a worker wait, so that in tests no time passes.
struct Pause {
    virtual ~Pause() = default;
    /// Returns after `time`, or at once when the worker has been told to stop.
    virtual void waitFor(Milliseconds time) = 0;
    virtual bool stopping() const = 0;
};

/// Waits in real time until somebody throws the switch. Any thread may call.
class StopSwitch : public Pause {
public:
    void stop();
    void waitFor(Milliseconds time) override;
    bool stopping() const override;

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stopping_ = false;
};

}  // namespace tilefarm
