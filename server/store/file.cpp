#include "server/store/file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "shared/file/durable_file.h"

namespace tilefarm {

File::File(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
    fd_ = ::open(path_.c_str(), (mode == Mode::read ? O_RDONLY : O_RDWR | O_CREAT) | O_CLOEXEC, 0644);
    if (fd_ < 0) throw fileError("open", path_, errno);
}

File::~File() {
    if (fd_ >= 0) ::close(fd_);
}

File::File(File&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

void File::writeAt(uint64_t offset, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw fileError("write", path_, errno);
        offset += static_cast<uint64_t>(written);
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
}

void File::readAt(uint64_t offset, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t got = ::pread(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw fileError("read", path_, errno);
        if (got == 0) throw Error(ErrorCode::internal, "'" + path_.string() + "' ends too early");
        offset += static_cast<uint64_t>(got);
        bytes = bytes.subspan(static_cast<size_t>(got));
    }
}

void File::syncData() {
    if (::fdatasync(fd_) != 0) throw fileError("sync", path_, errno);
}

uint64_t File::size() const {
    struct stat info {};
    if (::fstat(fd_, &info) != 0) throw fileError("stat", path_, errno);
    return static_cast<uint64_t>(info.st_size);
}

void makeFolder(const std::filesystem::path& folder) {
    if (folder.empty() || std::filesystem::is_directory(folder)) return;
    makeFolder(folder.parent_path());
    if (::mkdir(folder.c_str(), 0755) != 0 && errno != EEXIST)
        throw fileError("make the folder", folder, errno);
    syncFolder(folder.has_parent_path() ? folder.parent_path() : ".");
}

uint64_t freeBytes(const std::filesystem::path& folder) {
    struct statvfs info {};
    if (::statvfs(folder.c_str(), &info) != 0) throw fileError("measure the free space of", folder, errno);
    return uint64_t{info.f_bavail} * info.f_frsize;
}

std::string randomHex(size_t count) {
    std::array<unsigned char, 32> bytes{};
    if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
        throw Error(ErrorCode::internal, "no random bytes from the system");
    }
    std::string text;
    for (size_t i = 0; i < count; ++i) text += "0123456789abcdef"[bytes.at(i) & 15];
    return text;
}

}  // namespace tilefarm
