#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/error/error.h"

namespace tilefarm {

/// Names of files that are being written end so; one found at a program's start is of a crash.
inline constexpr std::string_view kUnfinishedSuffix = ".unfinished";

/// The Error of a failed system call on a file: outOfSpace for a full disk, quota or size limit,
/// notFound for a missing file or folder, else internal. Names the file, what was tried and why not.
Error fileError(std::string_view whatWasTried, const std::filesystem::path& path, int errnoValue);

/// A file that appears whole or not at all. Bytes go to a temporary file in the same folder; commit()
/// syncs it, gives it its name (replacing a file of that name) and syncs the folder, so that after it
/// returns the file outlives a power cut. Without commit() nothing remains. Not thread safe; writers
/// of the same path do not disturb each other, the last to commit wins. After a failed write commit()
/// fails too.
/// Everything throws Error as of fileError.
class DurableFile {
public:
    /// The folder must exist.
    explicit DurableFile(std::filesystem::path path);
    ~DurableFile();
    DurableFile(const DurableFile&) = delete;
    DurableFile& operator=(const DurableFile&) = delete;

    void write(std::span<const std::byte> bytes);
    void write(std::string_view text);
    /// Where the next byte goes; seeking back overwrites.
    uint64_t position() const { return flushed_ + buffer_.size(); }
    void seek(uint64_t position);
    void commit();

private:
    void flush();

    std::filesystem::path path_, temporary_;
    int fd_ = -1;
    int failure_ = 0;       // errno of a write that failed
    uint64_t flushed_ = 0;  // position of the first byte in buffer_
    std::vector<std::byte> buffer_;
};

/// Writes a whole file durably.
void writeDurably(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeDurably(const std::filesystem::path& path, std::string_view text);
/// Makes the names in a folder (created, renamed or removed files) outlive a power cut.
void syncFolder(const std::filesystem::path& folder);
/// Reads a whole file of at most `mostBytes`. Throws Error(notFound | tooLarge | internal).
std::vector<std::byte> readWhole(const std::filesystem::path& path, uint64_t mostBytes = UINT64_MAX);

}  // namespace tilefarm
