#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace tilefarm {

/// Where results are kept from run to run. Processes may share it. An empty path keeps nothing.
struct ComputedCache {
    std::filesystem::path folder;
    uint64_t mostBytes = uint64_t{512} << 20;  // above, what was used least recently goes
};

/// What `compute` gives, or gave in an earlier run for the same `kind` and `key`: the key holds all that the
/// result depends on, the computation's own version included. An empty result is not kept.
std::vector<std::byte> computedOnce(const ComputedCache& cache, std::string_view kind,
                                    std::span<const std::byte> key,
                                    const std::function<std::vector<std::byte>()>& compute);

}  // namespace tilefarm
