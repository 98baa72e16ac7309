#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/film/frame_images.h"
#include "server/queue/scheduler.h"
#include "server/report/metrics.h"

namespace tilefarm {

/// A thread for what happens by itself: leases run out, frames get their final image, and every
/// minute the invariants are checked. Faults are logged and tried again; they end nothing.
class Housekeeper {
public:
    Housekeeper(Scheduler& scheduler, FrameImages& images, Metrics& metrics);
    ~Housekeeper();
    /// Something changed: there may be a frame to finish.
    void wake();

private:
    void run();
    void step(bool sweep);
    void sweep();

    Scheduler& scheduler_;
    FrameImages& images_;
    Metrics& metrics_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool stopping_ = false, work_ = true;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace tilefarm
