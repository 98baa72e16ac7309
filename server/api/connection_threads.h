#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tilefarm {

/// A thread per connection, made when no idle one is left, up to a limit; beyond it connections wait.
/// The HTTP library ties a thread to a connection for its whole life, event streams included, so a
/// pool of fixed size would be starved by a few watchers.
class ConnectionThreads {
public:
    explicit ConnectionThreads(size_t most) : most_(most) {}
    ~ConnectionThreads() { stop(); }

    void run(std::function<void()> task) {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
        if (idle_ < tasks_.size() && threads_.size() < most_)
            threads_.emplace_back([this] { work(); });
        else
            added_.notify_one();
    }
    /// Finishes what was given and ends the threads.
    void stop() {
        {
            const std::scoped_lock lock(mutex_);
            stopping_ = true;
        }
        added_.notify_all();
        for (std::thread& thread : threads_) {
            if (thread.joinable()) thread.join();
        }
    }

private:
    void work() {
        std::unique_lock lock(mutex_);
        for (;;) {
            ++idle_;
            added_.wait(lock, [&] { return stopping_ || !tasks_.empty(); });
            --idle_;
            if (tasks_.empty()) return;
            auto task = std::move(tasks_.front());
            tasks_.pop_front();
            lock.unlock();
            task();
            lock.lock();
        }
    }

    const size_t most_;
    std::mutex mutex_;
    std::condition_variable added_;
    std::deque<std::function<void()>> tasks_;
    std::vector<std::thread> threads_;
    size_t idle_ = 0;
    bool stopping_ = false;
};

}  // namespace tilefarm
