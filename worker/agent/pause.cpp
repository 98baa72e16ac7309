#include "worker/agent/pause.h"

namespace tilefarm {

void StopSwitch::stop() {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
}

void StopSwitch::waitFor(Milliseconds time) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, time, [this] { return stopping_; });
}

bool StopSwitch::stopping() const {
    const std::lock_guard lock(mutex_);
    return stopping_;
}

}  // namespace tilefarm
