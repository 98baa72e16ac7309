#include "server/housekeeper.h"

#include <spdlog/spdlog.h>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

using std::chrono::steady_clock;

constexpr auto kLookEvery = std::chrono::milliseconds(200);
constexpr auto kSweepEvery = std::chrono::minutes(1);
constexpr auto kAfterAFault = std::chrono::seconds(2);  // a full disk: not in a tight circle

}  // namespace

Housekeeper::Housekeeper(Scheduler& scheduler, FrameImages& images, Metrics& metrics)
    : scheduler_(scheduler), images_(images), metrics_(metrics), thread_([this] { run(); }) {}

Housekeeper::~Housekeeper() {
    {
        const std::scoped_lock lock(mutex_);
        stopping_ = true;
    }
    woken_.notify_all();
    thread_.join();
}

void Housekeeper::wake() {
    {
        const std::scoped_lock lock(mutex_);
        work_ = true;
    }
    woken_.notify_all();
}

void Housekeeper::run() {
    auto nextSweep = steady_clock::now() + kSweepEvery;
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        woken_.wait_for(lock, kLookEvery, [&] { return stopping_ || work_; });
        work_ = false;
        lock.unlock();
        const bool sweep = steady_clock::now() >= nextSweep;
        if (sweep) nextSweep += kSweepEvery;
        bool well = true;
        try {
            step(sweep);
        } catch (const std::exception& fault) {
            spdlog::error("housekeeping: {}", fault.what());
            well = false;
        }
        lock.lock();
        if (!well) woken_.wait_for(lock, kAfterAFault, [&] { return stopping_; });
    }
}

void Housekeeper::step(bool withSweep) {
    scheduler_.expire();
    const auto faults = images_.finishFrames();
    if (withSweep) sweep();
    if (!faults.empty()) throw Error(ErrorCode::internal, "a frame cannot be finished: " + faults.front());
}

void Housekeeper::sweep() {
    const auto violations = scheduler_.sweep();
    metrics_.violations(violations.size());
    for (const Violation& v : violations) {
        spdlog::error("invariant {} broken at {}{}", v.invariant, v.detail, v.repaired ? ", repaired" : "");
    }
}

}  // namespace tilefarm
