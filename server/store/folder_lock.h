#pragma once

#include <filesystem>

namespace tilefarm {

/// Holds a data folder for one server: two would merge into each other's films. Makes the folder.
/// Throws Error(unavailable) if another process holds it, Error of fileError if it cannot be written.
class FolderLock {
public:
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int fd_ = -1;
};

}  // namespace tilefarm
