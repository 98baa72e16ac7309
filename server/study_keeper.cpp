#include "server/study_keeper.h"

#include <spdlog/spdlog.h>

namespace tilefarm {
namespace {

constexpr auto kLookForJobsEvery = std::chrono::milliseconds(300);
constexpr auto kAfterAStudyFault = std::chrono::seconds(2);  // a full disk: not in a tight circle

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
        bool more = false, well = true;
        try {
            more = studies_.step();
        } catch (const std::exception& fault) {
            spdlog::error("studies: {}", fault.what());
            well = false;
        }
        lock.lock();
        const auto stopping = [&] { return stopping_; };
        if (!well)
            woken_.wait_for(lock, kAfterAStudyFault, stopping);
        else if (!more)
            woken_.wait_for(lock, kLookForJobsEvery, stopping);
    }
}

}  // namespace tilefarm
