#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace tilefarm {

/// An open file for reading and writing anywhere; closes itself. Every call throws Error as of
/// fileError (shared/file).
class File {
public:
    enum class Mode { read, readWrite };  // readWrite makes the file if it is not there
    File(std::filesystem::path path, Mode mode);
    ~File();
    File(File&& other) noexcept;
    File& operator=(File&&) = delete;

    void writeAt(uint64_t offset, std::span<const std::byte> bytes);
    /// All of `bytes`, or Error(internal) if the file ends before.
    void readAt(uint64_t offset, std::span<std::byte> bytes) const;
    void syncData();
    uint64_t size() const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    int fd_ = -1;
};

/// Makes a folder and its parents, durably.
void makeFolder(const std::filesystem::path& folder);
/// Free bytes for unprivileged users on the disk of `folder`.
uint64_t freeBytes(const std::filesystem::path& folder);
/// Up to 32 random lower-case hex digits, for ids.
std::string randomHex(size_t count);

}  // namespace tilefarm
