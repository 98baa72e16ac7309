#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace tilefarm {

/// An encoded result with all that its upload says.
struct StoredResult {
    std::string leaseId;
    uint64_t epoch = 0;
    std::string jobId;
    double deviceSeconds = 0;
    bool whole = true;
    std::string sha256;  // of `exr`
    std::vector<std::byte> exr;
};

/// Finished results that the server could not take yet, on disk, so that neither a worker's end nor its
/// memory costs them: FOLDER/<process>/<number>.result. A process keeps its own folder locked; what an
/// ended one left for the same server is taken over by the next. Any thread may call.
class ResultStore {
public:
    ResultStore(const std::filesystem::path& folder, std::string server);
    /// Removes its folder if no result is left in it.
    ~ResultStore();
    ResultStore(const ResultStore&) = delete;
    ResultStore& operator=(const ResultStore&) = delete;

    /// Throws Error(outOfSpace | internal) that names the file.
    std::filesystem::path save(const StoredResult& result);
    /// Throws Error(unprocessable) if the file is damaged.
    StoredResult load(const std::filesystem::path& file) const;
    void remove(const std::filesystem::path& file);

    /// Moves the results of ended processes here and lists them, oldest first.
    std::vector<std::filesystem::path> adopt();

    /// This process, by the name of its folder, which is a random one.
    std::string session() const { return folder_.filename().string(); }
    /// Sessions that adopt() found to have been killed or to have crashed.
    const std::vector<std::string>& crashed() const { return crashed_; }

private:
    std::filesystem::path nextFile();

    const std::filesystem::path parent_;
    const std::string server_;
    std::filesystem::path folder_;
    std::vector<std::string> crashed_;
    int lock_ = -1;
    std::mutex mutex_;
    uint64_t saved_ = 0;
};

}  // namespace tilefarm
