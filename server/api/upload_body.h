#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace tilefarm {

/// How many bytes all requests together may keep in memory while they arrive. Any thread may call.
class MemoryBudget {
public:
    explicit MemoryBudget(uint64_t most) : most_(most) {}
    bool take(uint64_t bytes) {
        if (used_.fetch_add(bytes) + bytes <= most_) return true;
        used_ -= bytes;
        return false;
    }
    void give(uint64_t bytes) { used_ -= bytes; }

private:
    const uint64_t most_;
    std::atomic<uint64_t> used_{0};
};

/// A body while it arrives, from a line as slow as it may be: in memory if it is small and the budget has
/// room, else in a file without a name, which goes with this object. Throws Error as of fileError.
class UploadBody {
public:
    /// `bytes`: what was announced, if anything was; no more will be added.
    UploadBody(MemoryBudget& budget, const std::filesystem::path& folder, std::optional<uint64_t> bytes);
    ~UploadBody();
    UploadBody(const UploadBody&) = delete;
    UploadBody& operator=(const UploadBody&) = delete;

    void add(std::span<const std::byte> piece);
    /// All that was added, once.
    std::vector<std::byte> take();
    bool inMemory() const { return fd_ < 0; }

private:
    MemoryBudget& budget_;
    std::filesystem::path folder_;
    uint64_t reserved_ = 0;
    std::vector<std::byte> memory_;
    int fd_ = -1;
    uint64_t fileBytes_ = 0;
};

}  // namespace tilefarm
