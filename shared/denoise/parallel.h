#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace tilefarm {

/// Runs work(i) for every i < count on up to `threads` threads, the caller's among them. Which thread takes
/// which is chance: each must write its own part only. `work` must not throw.
template <typename Work>
void inParallel(uint32_t threads, int count, const Work& work) {
    std::atomic<int> next = 0;
    const auto run = [&] {
        for (int i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> others;
    for (uint32_t t = 1; t < threads && static_cast<int>(t) < count; ++t) others.emplace_back(run);
    run();
}

}  // namespace tilefarm
