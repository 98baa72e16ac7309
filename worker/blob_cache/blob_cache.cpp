#include "worker/blob_cache/blob_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/digest/digest.h"
#include "shared/error/error.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

// Another process with the same cache may be writing its own; only older ones are of a crash.
constexpr auto kLeftoverAge = std::chrono::hours(24);

ErrorCode codeOf(const std::error_code& error) {
    return error == std::errc::no_space_on_device ? ErrorCode::outOfSpace : ErrorCode::internal;
}

[[noreturn]] void fail(const char* what, const fs::path& path, const std::error_code& error) {
    throw Error(codeOf(error), fmt::format("cannot {} {}: {}", what, path.string(), error.message()));
}

void makeFolder(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) fail("make the cache folder", path, error);
}

fs::path temporaryIn(const fs::path& folder) {
    std::string name = (folder / "XXXXXX").string();
    if (!mkdtemp(name.data())) fail("make a folder", name, {errno, std::generic_category()});
    return name;
}

void removeLeftovers(const fs::path& folder) {
    std::error_code ignored;
    const auto now = fs::file_time_type::clock::now();
    for (const auto& item : fs::directory_iterator(folder, ignored))
        if (now - item.last_write_time(ignored) > kLeftoverAge) fs::remove_all(item.path(), ignored);
}

// The reader's own folder, gone with it, so that two fetches of one blob never meet.
struct TemporaryFolder {
    explicit TemporaryFolder(const fs::path& parent) : path(temporaryIn(parent)) {}
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    fs::path path;
};

}  // namespace

BlobCache::BlobCache(fs::path folder, uint64_t limitBytes)
    : folder_(std::move(folder)), limitBytes_(limitBytes) {
    for (const char* part : {"blobs", "incoming", "scenes"}) makeFolder(folder_ / part);
    removeLeftovers(folder_ / "incoming");
    removeLeftovers(folder_ / "scenes");
    readFolder();
}

fs::path BlobCache::pathOf(const std::string& sha256) const {
    return folder_ / "blobs" / sha256.substr(0, 2) / sha256;
}

void BlobCache::readFolder() {
    std::vector<std::pair<fs::file_time_type, fs::path>> files;
    std::error_code ignored;
    for (const auto& item : fs::recursive_directory_iterator(folder_ / "blobs", ignored))
        if (item.is_regular_file(ignored) && isSha256Hex(item.path().filename().string()))
            files.emplace_back(item.last_write_time(ignored), item.path());
    std::sort(files.begin(), files.end());  // the times of files are those of their last use
    for (const auto& [time, path] : files) {
        const uint64_t size = fs::file_size(path, ignored);
        entries_[path.filename().string()] = {size, ++uses_, false};
        bytes_ += size;
    }
    evict();
}

void BlobCache::link(const std::string& sha256, const fs::path& target, const BlobSource& source) {
    if (!isSha256Hex(sha256)) throw Error(ErrorCode::invalidArgument, "not a SHA-256: " + sha256);
    makeFolder(target.parent_path());
    std::error_code error;
    // Between the check and the link another process may throw the file out; then it is fetched again.
    for (int attempt = 0; attempt < 3; ++attempt) {
        if (!isSound(sha256)) fetch(sha256, source);
        error.clear();
        fs::create_hard_link(pathOf(sha256), target, error);
        if (error && error != std::errc::no_such_file_or_directory) {
            error.clear();  // a file system without hard links
            fs::copy_file(pathOf(sha256), target, error);
        }
        if (!error) break;
    }
    if (error) fail("link a blob as", target, error);
    std::error_code ignored;
    fs::last_write_time(pathOf(sha256), fs::file_time_type::clock::now(), ignored);
    const std::lock_guard lock(mutex_);
    entries_[sha256].lastUse = ++uses_;
    evict();
}

// True if the blob is here and is what its name says.
bool BlobCache::isSound(const std::string& sha256) {
    const fs::path path = pathOf(sha256);
    std::error_code error;
    const uint64_t size = fs::file_size(path, error);
    const bool here = !error;
    bool verified = false;
    {
        const std::lock_guard lock(mutex_);
        if (here) {
            Entry& entry = entries_[sha256];
            bytes_ += size - entry.bytes;
            verified = entry.verified && entry.bytes == size;
            entry.bytes = size;
        } else if (const auto gone = entries_.find(sha256); gone != entries_.end()) {
            bytes_ -= gone->second.bytes;
            entries_.erase(gone);
        }
    }
    if (!here || verified) return here;
    if (sha256OfFile(path) != sha256) return false;  // fetch() puts a good one in its place
    const std::lock_guard lock(mutex_);
    entries_[sha256].verified = true;
    return true;
}

void BlobCache::fetch(const std::string& sha256, const BlobSource& source) {
    std::unique_lock lock(mutex_);
    if (beingFetched_.contains(sha256)) {
        fetched_.wait(lock, [&] { return !beingFetched_.contains(sha256); });
        return;  // link() looks again, and fetches itself if the other failed
    }
    beingFetched_.insert(sha256);
    lock.unlock();
    struct Done {
        BlobCache& cache;
        const std::string& sha256;
        ~Done() {
            const std::lock_guard doneLock(cache.mutex_);
            cache.beingFetched_.erase(sha256);
            cache.fetched_.notify_all();
        }
    } const done{*this, sha256};
    if (isSound(sha256)) return;  // another thread was done with it just before

    const TemporaryFolder incoming(folder_ / "incoming");
    const fs::path file = incoming.path / "blob";
    std::string arrived;
    for (int attempt = 0; attempt < 2 && arrived != sha256; ++attempt) {
        source(sha256, file);
        arrived = sha256OfFile(file);
    }
    if (arrived != sha256)
        throw Error(ErrorCode::unprocessable, fmt::format("blob {} arrived with digest {}", sha256, arrived));
    makeFolder(pathOf(sha256).parent_path());
    std::error_code error;
    const uint64_t size = fs::file_size(file, error);
    if (!error) fs::rename(file, pathOf(sha256), error);
    if (error) fail("keep the blob", pathOf(sha256), error);
    const std::lock_guard keep(mutex_);
    Entry& entry = entries_[sha256];
    bytes_ += size - entry.bytes;
    entry = {size, ++uses_, true};
}

// The newest stays even where it alone is beyond the limit: it is in use.
void BlobCache::evict() {
    while (bytes_ > limitBytes_ && entries_.size() > 1) {
        const auto oldest = std::min_element(
            entries_.begin(), entries_.end(),
            [](const auto& a, const auto& b) { return a.second.lastUse < b.second.lastUse; });
        std::error_code ignored;
        fs::remove(pathOf(oldest->first), ignored);
        bytes_ -= oldest->second.bytes;
        entries_.erase(oldest);
    }
}

uint64_t BlobCache::bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

fs::path BlobCache::makeSceneFolder() {
    return temporaryIn(folder_ / "scenes");
}

}  // namespace tilefarm
