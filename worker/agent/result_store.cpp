#include "worker/agent/result_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

constexpr const char* kLock = "lock";
constexpr const char* kSuffix = ".result";
constexpr const char* kAtWork = "at-work";  // gone once a process has ended by itself

// The lock file of a folder, locked, or -1 if another process has it. The system lets go of the lock
// when the process ends in whatever way.
int tryLock(const fs::path& folder, int flags) {
    const int fd = open((folder / kLock).c_str(), O_RDWR | O_CLOEXEC | flags, 0644);
    if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) != 0) {
        close(fd);
        return -1;
    }
    return fd;
}

nlohmann::json headerOf(const StoredResult& result, const std::string& server) {
    return {{"server", server},
            {"lease", result.leaseId},
            {"epoch", result.epoch},
            {"job", result.jobId},
            {"deviceSeconds", result.deviceSeconds},
            {"whole", result.whole},
            {"sha256", result.sha256}};
}

StoredResult fromHeader(const nlohmann::json& header) {
    StoredResult result;
    header.at("lease").get_to(result.leaseId);
    header.at("epoch").get_to(result.epoch);
    header.at("job").get_to(result.jobId);
    header.at("deviceSeconds").get_to(result.deviceSeconds);
    header.at("whole").get_to(result.whole);
    header.at("sha256").get_to(result.sha256);
    return result;
}

Error damaged(const fs::path& file, const std::string& why) {
    return {ErrorCode::unprocessable, fmt::format("{} is no result of a worker: {}", file.string(), why)};
}

// A file is a line of JSON and the EXR.
std::pair<nlohmann::json, std::span<const std::byte>> split(const fs::path& file,
                                                            std::span<const std::byte> bytes) {
    const auto end = std::find(bytes.begin(), bytes.end(), std::byte{'\n'});
    if (end == bytes.end()) throw damaged(file, "it has no header");
    const auto length = static_cast<size_t>(end - bytes.begin());
    const std::string_view line(reinterpret_cast<const char*>(bytes.data()), length);
    auto header = nlohmann::json::parse(line, nullptr, false);
    if (!header.is_object()) throw damaged(file, "its header is no JSON");
    return {std::move(header), bytes.subspan(length + 1)};
}

std::vector<fs::path> resultsIn(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code ignored;
    for (const auto& item : fs::directory_iterator(folder, ignored))
        if (item.path().extension() == kSuffix) files.push_back(item.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

ResultStore::ResultStore(const fs::path& folder, std::string server)
    : parent_(folder), server_(std::move(server)) {
    std::error_code error;
    fs::create_directories(parent_, error);
    // A process that adopts may lock and remove a folder between its making and its locking.
    for (int attempt = 0; attempt < 10 && lock_ < 0; ++attempt) {
        std::string name = (parent_ / "XXXXXX").string();
        if (!mkdtemp(name.data())) throw fileError("make a folder for results", name, errno);
        folder_ = name;
        lock_ = tryLock(folder_, O_CREAT);
        if (lock_ >= 0 && !fs::exists(folder_ / kLock)) close(std::exchange(lock_, -1));
    }
    if (lock_ < 0)
        throw Error(ErrorCode::internal, "cannot lock a folder for results in " + parent_.string());
    std::ofstream(folder_ / kAtWork).flush();
}

ResultStore::~ResultStore() {
    std::error_code ignored;
    fs::remove(folder_ / kAtWork, ignored);
    if (resultsIn(folder_).empty()) fs::remove_all(folder_, ignored);
    close(lock_);
}

fs::path ResultStore::nextFile() {
    const std::lock_guard lock(mutex_);
    return folder_ / fmt::format("{:08}{}", saved_++, kSuffix);
}

fs::path ResultStore::save(const StoredResult& result) {
    const fs::path path = nextFile();
    DurableFile file(path);
    file.write(headerOf(result, server_).dump() + "\n");
    file.write(result.exr);
    file.commit();
    return path;
}

StoredResult ResultStore::load(const fs::path& file) const {
    const std::vector<std::byte> bytes = readWhole(file);
    try {
        const auto [header, exr] = split(file, bytes);
        StoredResult result = fromHeader(header);
        if (sha256Hex(exr) != result.sha256) throw damaged(file, "its digest is another");
        result.exr.assign(exr.begin(), exr.end());
        return result;
    } catch (const nlohmann::json::exception& error) {
        throw damaged(file, error.what());
    }
}

void ResultStore::remove(const fs::path& file) {
    std::error_code ignored;
    fs::remove(file, ignored);
}

std::vector<fs::path> ResultStore::adopt() {
    std::vector<fs::path> adopted;
    std::error_code ignored;
    for (const auto& item : fs::directory_iterator(parent_, ignored)) {
        if (item.path() == folder_) continue;
        const int lock = tryLock(item.path(), 0);
        if (lock < 0) continue;
        if (fs::remove(item.path() / kAtWork, ignored)) crashed_.push_back(item.path().filename().string());
        for (const fs::path& file : resultsIn(item.path())) {
            try {
                const std::vector<std::byte> bytes = readWhole(file);
                if (split(file, bytes).first.value("server", "") != server_) continue;
                const fs::path mine = nextFile();
                fs::rename(file, mine);
                adopted.push_back(mine);
            } catch (const std::exception&) {
                fs::remove(file, ignored);  // damaged: of no use to anybody
            }
        }
        if (resultsIn(item.path()).empty()) fs::remove_all(item.path(), ignored);
        close(lock);
    }
    return adopted;
}

}  // namespace tilefarm
