#pragma once

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <system_error>
#include <vector>

namespace tilefarm {

/// A thread per connection, made when no idle one is left, up to a limit; beyond it connections wait.
/// The HTTP library ties a thread to a connection for its whole life, event streams included, so a
/// pool of fixed size would be starved by a few watchers.
class ConnectionThreads {
public:
    /// Of each thread, whatever the limits of the shell. The library matches the header Range, a line of
    /// which it bounds at 8 kB, by std::regex, which takes some 330 bytes of stack per character
    /// (libstdc++ 12): at most 3 MB.
    static constexpr size_t kStackBytes = 8u << 20;

    explicit ConnectionThreads(size_t most) : most_(most) {}
    ~ConnectionThreads() { stop(); }

    void run(std::function<void()> task) {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
        if (idle_ < tasks_.size() && threads_.size() < most_)
            threads_.push_back(start());
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
        for (const pthread_t thread : threads_) pthread_join(thread, nullptr);
        threads_.clear();
    }

private:
    pthread_t start() {
        const auto body = [](void* self) -> void* {
            static_cast<ConnectionThreads*>(self)->work();
            return nullptr;
        };
        pthread_t thread{};
        pthread_attr_t attributes{};
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, kStackBytes);
        const int error = pthread_create(&thread, &attributes, body, this);
        pthread_attr_destroy(&attributes);
        if (error != 0) throw std::system_error(error, std::generic_category(), "cannot start a thread");
        return thread;
    }
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
    std::vector<pthread_t> threads_;
    size_t idle_ = 0;
    bool stopping_ = false;
};

}  // namespace tilefarm
