#pragma once

#include <filesystem>

#include "server/store/blob_store.h"

namespace tilefarm {

/// Blobs as files FOLDER/ab/abcdef…, written beside and renamed. Unfinished ones of an earlier run
/// are removed when the store opens.
class FileBlobStore : public BlobStore {
public:
    explicit FileBlobStore(std::filesystem::path folder);
    std::optional<uint64_t> size(const std::string& sha256) const override;
    std::unique_ptr<BlobWriter> create(const std::string& sha256) override;
    void read(const std::string& sha256, uint64_t offset, std::span<std::byte> into) const override;

private:
    std::filesystem::path pathOf(const std::string& sha256) const;
    std::filesystem::path folder_;
};

}  // namespace tilefarm
