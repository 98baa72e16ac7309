#include "worker/agent/result_queue.h"

#include <utility>

namespace tilefarm {

uint64_t FinishedResult::filmBytes() const {
    uint64_t bytes = 0;
    for (const PassFilm& film : films) bytes += film.pixels.size() * sizeof(PassPixel) + film.extra.size() * sizeof(float);
    return bytes;
}

bool ResultQueue::isFull() const {
    size_t inMemory = 0;
    uint64_t bytes = 0;
    for (const FinishedResult& result : results_) {
        inMemory += !result.films.empty();
        bytes += result.filmBytes();
    }
    return inMemory >= kMost || bytes >= kManyBytes;
}

void ResultQueue::push(FinishedResult result) {
    std::unique_lock lock(mutex_);
    if (!result.films.empty()) changed_.wait(lock, [this] { return !isFull(); });
    results_.push_back(std::move(result));
    changed_.notify_all();
}

std::optional<FinishedResult> ResultQueue::take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !results_.empty(); });
    if (results_.empty()) return std::nullopt;
    FinishedResult result = std::move(results_.front());
    results_.pop_front();
    changed_.notify_all();
    return result;
}

void ResultQueue::close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

size_t ResultQueue::size() const {
    const std::lock_guard lock(mutex_);
    return results_.size();
}

}  // namespace tilefarm
