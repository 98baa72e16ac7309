#include "server/study_keeper.h"

#include <spdlog/spdlog.h>

namespace tilefarm {
namespace {

constexpr auto kLookForJobsEvery = std::chrono::milliseconds(300);

}  // namespace

StudyKeeper::StudyKeeper(StudyRunner& studies) : studies_(studies), thread_([this] { run(); }) {}

StudyKeeper::~StudyKeeper() {
    {
        const std::scoped_lock lock(mutex_);
        stopping_ = true;
    }
    woken_.notify_all();
    thread_.join();
}

void StudyKeeper::run() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        lock.unlock();
        bool more = false;
        try {
            more = studies_.step();
        } catch (const std::exception& fault) {
            spdlog::error("studies: {}", fault.what());
        }
        lock.lock();
        if (!more) woken_.wait_for(lock, kLookForJobsEvery, [&] { return stopping_; });
    }
}

}  // namespace tilefarm
