#pragma once

#include <map>
#include <mutex>
#include <vector>

#include "server/store/blob_store.h"

namespace tilefarm {

/// Blobs in memory, for tests.
class MemoryBlobStore : public BlobStore {
public:
    std::optional<uint64_t> size(const std::string& sha256) const override;
    std::unique_ptr<BlobWriter> create(const std::string& sha256) override;
    void read(const std::string& sha256, uint64_t offset, std::span<std::byte> into) const override;

private:
    friend class MemoryBlobWriter;
    mutable std::mutex mutex_;
    std::map<std::string, std::vector<std::byte>> blobs_;
};

}  // namespace tilefarm
