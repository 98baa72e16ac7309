#include "worker/cache_file/computed_cache.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "shared/digest/digest.h"
#include "worker/cache_file/cache_file.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".computed";

struct Kept {
    fs::file_time_type used;
    uint64_t bytes;
    fs::path path;
};

std::vector<Kept> keptIn(const fs::path& folder) {
    std::vector<Kept> kept;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(folder, failed)) {
        if (entry.path().extension() != kExtension) continue;
        const Kept each{entry.last_write_time(failed), entry.file_size(failed), entry.path()};
        if (!failed) kept.push_back(each);  // else another process has removed it meanwhile
    }
    return kept;
}

void keepAtMost(const ComputedCache& cache) {
    std::vector<Kept> kept = keptIn(cache.folder);
    std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.used > b.used; });
    uint64_t bytes = 0;
    std::error_code ignored;
    for (const Kept& each : kept)
        if ((bytes += each.bytes) > cache.mostBytes) fs::remove(each.path, ignored);
}

}  // namespace

std::vector<std::byte> computedOnce(const ComputedCache& cache, std::string_view kind,
                                    std::span<const std::byte> key,
                                    const std::function<std::vector<std::byte>()>& compute) {
    if (cache.folder.empty()) return compute();
    const fs::path path = cache.folder / fmt::format("{}-{}{}", kind, sha256Hex(key), kExtension);
    std::vector<std::byte> bytes = readCacheFile(path);
    std::error_code ignored;
    if (!bytes.empty()) {
        fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
        return bytes;
    }
    bytes = compute();
    if (bytes.empty()) return bytes;
    writeCacheFile(path, bytes);
    keepAtMost(cache);
    return bytes;
}

}  // namespace tilefarm
