#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "shared/clock/clock.h"

namespace tilefarm {

/// Wakes those who wait for new rows of the events table; the facts are in the table alone.
class EventBus {
public:
    void publish() {
        {
            const std::scoped_lock lock(mutex_);
            ++version_;
        }
        published_.notify_all();
    }
    /// Ends every wait, now and later.
    void close() {
        {
            const std::scoped_lock lock(mutex_);
            closed_ = true;
        }
        published_.notify_all();
    }
    bool closed() const {
        const std::scoped_lock lock(mutex_);
        return closed_;
    }
    uint64_t version() const {
        const std::scoped_lock lock(mutex_);
        return version_;
    }
    /// Waits for a version above `known`, at most `timeout`.
    void waitBeyond(uint64_t known, Milliseconds timeout) const {
        std::unique_lock lock(mutex_);
        published_.wait_for(lock, timeout, [&] { return closed_ || version_ > known; });
    }

private:
    mutable std::mutex mutex_;
    mutable std::condition_variable published_;
    uint64_t version_ = 0;
    bool closed_ = false;
};

}  // namespace tilefarm
