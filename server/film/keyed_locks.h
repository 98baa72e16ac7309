#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>

namespace tilefarm {

/// Keeps two threads off the same key; those of other keys go on.
class KeyedLocks {
public:
    class Hold {
    public:
        Hold(KeyedLocks& locks, std::string key) : locks_(locks), key_(std::move(key)) {
            std::unique_lock lock(locks_.mutex_);
            locks_.freed_.wait(lock, [&] { return !locks_.held_.contains(key_); });
            locks_.held_.insert(key_);
        }
        ~Hold() {
            {
                const std::scoped_lock lock(locks_.mutex_);
                locks_.held_.erase(key_);
            }
            locks_.freed_.notify_all();
        }
        Hold(const Hold&) = delete;
        Hold& operator=(const Hold&) = delete;

    private:
        KeyedLocks& locks_;
        const std::string key_;
    };

private:
    std::mutex mutex_;
    std::condition_variable freed_;
    std::set<std::string> held_;
};

}  // namespace tilefarm
