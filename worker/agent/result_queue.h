#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "shared/film/film.h"
#include "shared/image/exr.h"

namespace tilefarm {

struct HeldLease;

/// What is rendered of a lease, on its way to the server: as films, or as a file that an earlier run
/// left in the ResultStore.
struct FinishedResult {
    std::string leaseId;
    uint64_t epoch = 0;
    std::string jobId;
    std::shared_ptr<HeldLease> lease;  // null if of an earlier run
    double deviceSeconds = 0;
    bool whole = true;  // false: passes of the lease are missing, to be handed back

    std::vector<PassFilm> films;
    ImageSpec image;
    ImageAttributes attributes;
    std::filesystem::path file;  // where there are no films

    uint64_t filmBytes() const;
};

/// Few enough results to bound memory, enough that uploads overlap rendering. Any thread may call.
class ResultQueue {
public:
    /// Waits while there are two already, or one that is `kManyBytes` big. One of an earlier run,
    /// which takes no memory, never waits.
    void push(FinishedResult result);
    /// Waits for one; nothing once the queue is closed and empty.
    std::optional<FinishedResult> take();
    void close();
    size_t size() const;

    static constexpr size_t kMost = 2;
    static constexpr uint64_t kManyBytes = uint64_t{512} << 20;

private:
    bool isFull() const;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<FinishedResult> results_;
    bool closed_ = false;
};

}  // namespace tilefarm
