#pragma once

#include <filesystem>
#include <memory>

#include "server/store/job_store.h"

namespace tilefarm {

/// The rows in an SQLite file. WAL with synchronous=FULL: a committed transaction survives power
/// loss. One connection does all writes and checkpoints (SQLite 3.40.1 has a checkpoint race between
/// several writing ones); readers have their own and do not wait.
class SqliteJobStore : public JobStore {
public:
    /// Opens or makes the file and migrates it. Throws Error(versionRefused) for a file of a newer
    /// Tilefarm, Error(internal) that names the file if it cannot be used.
    explicit SqliteJobStore(const std::filesystem::path& file);
    ~SqliteJobStore() override;
    void write(const std::function<void(Tables&)>& work) override;
    void read(const std::function<void(const ConstTables&)>& work) const override;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
