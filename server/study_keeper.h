#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/study/runner.h"

namespace tilefarm {

/// A thread that advances studies: comparing pictures takes seconds, for which nothing else waits. Faults are
/// logged and tried again.
class StudyKeeper {
public:
    explicit StudyKeeper(StudyRunner& studies);
    ~StudyKeeper();

private:
    void run();

    StudyRunner& studies_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool stopping_ = false;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace tilefarm
