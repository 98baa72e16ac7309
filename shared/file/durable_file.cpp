#include "shared/file/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

namespace tilefarm {

namespace fs = std::filesystem;

namespace {

constexpr size_t kBufferBytes = 256 * 1024;

ErrorCode codeOf(int errnoValue) {
    switch (errnoValue) {
        case ENOSPC:
        case EDQUOT:
        case EFBIG: return ErrorCode::outOfSpace;
        case ENOENT:
        case ENOTDIR: return ErrorCode::notFound;
        default: return ErrorCode::internal;
    }
}

// Unique among the processes and threads that write into one folder.
fs::path temporaryBeside(const fs::path& path) {
    static std::atomic<unsigned> serial{0};
    const std::string suffix = '.' + std::to_string(getpid()) + '.' + std::to_string(serial++);
    return path.parent_path() / ('.' + path.filename().string() + suffix + std::string(kUnfinishedSuffix));
}

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

struct Descriptor {
    int fd;
    ~Descriptor() {
        if (fd >= 0) close(fd);
    }
};

}  // namespace

Error fileError(std::string_view whatWasTried, const fs::path& path, int errnoValue) {
    return {codeOf(errnoValue), "cannot " + std::string(whatWasTried) + " '" + path.string() +
                                    "': " + std::generic_category().message(errnoValue)};
}

DurableFile::DurableFile(fs::path path) : path_(std::move(path)), temporary_(temporaryBeside(path_)) {
    fd_ = open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (fd_ < 0) throw fileError("create", path_, errno);
}

DurableFile::~DurableFile() {
    if (fd_ < 0) return;
    close(fd_);
    unlink(temporary_.c_str());
}

void DurableFile::write(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    if (buffer_.size() >= kBufferBytes) flush();
}

void DurableFile::write(std::string_view text) {
    write(bytesOf(text));
}

void DurableFile::seek(uint64_t position) {
    flush();
    flushed_ = position;
}

void DurableFile::flush() {
    size_t done = 0;
    while (done < buffer_.size()) {
        const ssize_t n =
            pwrite(fd_, buffer_.data() + done, buffer_.size() - done, static_cast<off_t>(flushed_ + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
            failure_ = errno;
            throw fileError("write", path_, failure_);
        }
        done += static_cast<size_t>(n);
    }
    flushed_ += done;
    buffer_.clear();
}

void DurableFile::commit() {
    // A caller may have swallowed the fault (OpenEXR's destructors do); the file is spoilt all the same.
    if (failure_ != 0) throw fileError("write", path_, failure_);
    flush();
    if (fsync(fd_) != 0) throw fileError("sync", path_, errno);
    if (rename(temporary_.c_str(), path_.c_str()) != 0) throw fileError("rename to", path_, errno);
    close(std::exchange(fd_, -1));
    syncFolder(folderOf(path_));
}

void writeDurably(const fs::path& path, std::span<const std::byte> bytes) {
    DurableFile file(path);
    file.write(bytes);
    file.commit();
}

void writeDurably(const fs::path& path, std::string_view text) {
    writeDurably(path, bytesOf(text));
}

void syncFolder(const fs::path& folder) {
    const Descriptor descriptor{open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (descriptor.fd < 0) throw fileError("open folder", folder, errno);
    // Some file systems cannot sync a folder and say EINVAL; there is nothing more to be had there.
    if (fsync(descriptor.fd) != 0 && errno != EINVAL) throw fileError("sync folder", folder, errno);
}

std::vector<std::byte> readWhole(const fs::path& path, uint64_t mostBytes) {
    const Descriptor descriptor{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    struct stat about {};
    if (descriptor.fd < 0 || fstat(descriptor.fd, &about) != 0) throw fileError("read", path, errno);
    if (S_ISDIR(about.st_mode)) throw fileError("read", path, EISDIR);
    const auto size = static_cast<uint64_t>(about.st_size);
    if (size > mostBytes)
        throw Error(ErrorCode::tooLarge, "'" + path.string() + "' has " + std::to_string(size) +
                                             " bytes, more than the " + std::to_string(mostBytes) +
                                             " allowed");
    std::vector<std::byte> bytes(size);
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = read(descriptor.fd, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw fileError("read", path, errno);
        if (n == 0) break;  // it shrank meanwhile
        done += static_cast<size_t>(n);
    }
    bytes.resize(done);
    return bytes;
}

}  // namespace tilefarm
