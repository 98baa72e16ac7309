#pragma once

#include <condition_variable>
#include <list>
#include <mutex>

namespace tilefarm {

/// Lets a number of threads in at a time, the others in the order in which they came. Whoever leaves wakes
/// the next one alone.
class FairGate {
public:
    explicit FairGate(size_t most) : free_(most) {}

    size_t waiting() const {
        const std::scoped_lock lock(mutex_);
        return waiting_.size();
    }

    /// Inside for as long as it lives.
    class Pass {
    public:
        explicit Pass(FairGate& gate) : gate_(gate) { gate_.enter(); }
        ~Pass() { gate_.leave(); }
        Pass(const Pass&) = delete;
        Pass& operator=(const Pass&) = delete;

    private:
        FairGate& gate_;
    };

private:
    struct Waiter {
        std::condition_variable called;
        bool in = false;
    };

    void enter() {
        std::unique_lock lock(mutex_);
        if (free_ > 0) {
            --free_;
            return;
        }
        Waiter& self = waiting_.emplace_back();
        self.called.wait(lock, [&] { return self.in; });
        waiting_.remove_if([&](const Waiter& waiter) { return &waiter == &self; });
    }
    // The place goes to the first who waits, so that a newcomer cannot take it in between.
    void leave() {
        const std::scoped_lock lock(mutex_);
        for (Waiter& waiter : waiting_) {
            if (waiter.in) continue;
            waiter.in = true;
            waiter.called.notify_one();
            return;
        }
        ++free_;
    }

    mutable std::mutex mutex_;
    std::list<Waiter> waiting_;
    size_t free_;
};

}  // namespace tilefarm
