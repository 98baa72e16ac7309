#include "server/store/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "server/store/file.h"
#include "shared/file/durable_file.h"

namespace tilefarm {

FolderLock::FolderLock(const std::filesystem::path& folder) {
    makeFolder(folder);
    const auto path = folder / "lock";
    fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (fd_ < 0) throw fileError("write into the data folder", folder, errno);
    if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(fd_);
    throw Error(ErrorCode::unavailable, "another server is using the folder '" + folder.string() + "'");
}

FolderLock::~FolderLock() {
    ::close(fd_);
}

}  // namespace tilefarm
