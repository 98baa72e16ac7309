#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace tilefarm {

/// Fetches the blob of that SHA-256 into a file. What it throws comes out of the cache unchanged.
using BlobSource = std::function<void(const std::string& sha256, const std::filesystem::path& file)>;

/// Files named by their SHA-256 under FOLDER/blobs/ab/…, at most `limitBytes` of them; the ones not
/// used for longest go first. A blob is hashed when it arrives and when this object first uses it, so
/// a file that went bad on the disk is fetched again. Several threads, and several processes with the
/// same folder, may use it at once: files appear by rename and are handed out as hard links.
class BlobCache {
public:
    /// Makes the folder. Leftovers of a crash are removed. Throws Error(internal) if it cannot.
    BlobCache(std::filesystem::path folder, uint64_t limitBytes);

    /// Puts the blob under the name `target`, which stays valid whatever the cache throws out later.
    /// `source` is asked only for what is not here, by one thread at a time for each blob. Throws
    /// Error(unprocessable) if what arrives has another digest, twice in a row.
    void link(const std::string& sha256, const std::filesystem::path& target, const BlobSource& source);

    /// Bytes kept now.
    uint64_t bytes() const;
    /// A fresh empty folder below the cache's own, for scenes; the caller removes it.
    std::filesystem::path makeSceneFolder();

private:
    struct Entry {
        uint64_t bytes = 0;
        uint64_t lastUse = 0;   // grows with every use
        bool verified = false;  // by this object
    };

    std::filesystem::path pathOf(const std::string& sha256) const;
    void readFolder();
    bool isSound(const std::string& sha256);
    void fetch(const std::string& sha256, const BlobSource& source);
    void evict();

    const std::filesystem::path folder_;
    const uint64_t limitBytes_;
    mutable std::mutex mutex_;
    std::condition_variable fetched_;
    std::map<std::string, Entry> entries_;
    std::set<std::string> beingFetched_;
    uint64_t uses_ = 0;
    uint64_t bytes_ = 0;
};

}  // namespace tilefarm
