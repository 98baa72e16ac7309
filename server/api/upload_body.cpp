#include "server/api/upload_body.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "shared/file/durable_file.h"

namespace tilefarm {
namespace {

constexpr uint64_t kMostInMemory = 1 << 20;

int openNameless(const std::filesystem::path& folder) {
    const int fd = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (fd >= 0) return fd;
    std::string name = (folder / "upload-XXXXXX").string();  // file systems without such files
    const int named = mkostemp(name.data(), O_CLOEXEC);
    if (named < 0) throw fileError("creating a file for an upload", folder, errno);
    unlink(name.c_str());
    return named;
}

}  // namespace

UploadBody::UploadBody(MemoryBudget& budget, const std::filesystem::path& folder,
                       std::optional<uint64_t> bytes)
    : budget_(budget), folder_(folder) {
    if (bytes && *bytes <= kMostInMemory && budget.take(*bytes)) {
        reserved_ = *bytes;
        memory_.reserve(*bytes);
    } else {
        fd_ = openNameless(folder);
    }
}

UploadBody::~UploadBody() {
    budget_.give(reserved_);
    if (fd_ >= 0) close(fd_);
}

void UploadBody::add(std::span<const std::byte> piece) {
    if (inMemory()) {
        memory_.insert(memory_.end(), piece.begin(), piece.end());
        return;
    }
    while (!piece.empty()) {
        const ssize_t written = write(fd_, piece.data(), piece.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw fileError("writing an upload", folder_, errno);
        piece = piece.subspan(static_cast<size_t>(written));
        fileBytes_ += static_cast<uint64_t>(written);
    }
}

std::vector<std::byte> UploadBody::take() {
    if (inMemory()) return std::move(memory_);
    std::vector<std::byte> bytes(fileBytes_);
    for (size_t at = 0; at < bytes.size();) {
        const ssize_t got = pread(fd_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw fileError("reading an upload", folder_, got < 0 ? errno : EIO);
        at += static_cast<size_t>(got);
    }
    return bytes;
}

}  // namespace tilefarm
