#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <tuple>
#include <vector>

#include "server/store/rows.h"

namespace tilefarm {

/// Keeps two threads off the same film tile. A holder waits for all of its tiles at once, so holders
/// cannot block one another for ever.
class TileLocks {
public:
    class Hold {
    public:
        Hold(TileLocks& locks, JobKey job, int32_t frame, const std::vector<uint32_t>& tiles)
            : locks_(locks) {
            for (const uint32_t tile : tiles) keys_.emplace(job, frame, tile);
            std::unique_lock lock(locks_.mutex_);
            locks_.freed_.wait(lock, [&] { return locks_.allFree(keys_); });
            locks_.held_.insert(keys_.begin(), keys_.end());
        }
        ~Hold() {
            {
                const std::scoped_lock lock(locks_.mutex_);
                for (const Key& key : keys_) locks_.held_.erase(key);
            }
            locks_.freed_.notify_all();
        }
        Hold(const Hold&) = delete;
        Hold& operator=(const Hold&) = delete;

    private:
        TileLocks& locks_;
        std::set<std::tuple<JobKey, int32_t, uint32_t>> keys_;
    };

private:
    using Key = std::tuple<JobKey, int32_t, uint32_t>;
    bool allFree(const std::set<Key>& keys) const {
        for (const Key& key : keys) {
            if (held_.contains(key)) return false;
        }
        return true;
    }

    std::mutex mutex_;
    std::condition_variable freed_;
    std::set<Key> held_;
};

}  // namespace tilefarm
