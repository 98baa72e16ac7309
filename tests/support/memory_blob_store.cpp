#include "tests/support/memory_blob_store.h"

#include <algorithm>

#include "shared/digest/digest.h"
#include "shared/error/error.h"

namespace tilefarm {

class MemoryBlobWriter : public BlobWriter {
public:
    MemoryBlobWriter(MemoryBlobStore& store, std::string sha256)
        : store_(store), sha256_(std::move(sha256)) {}
    void write(std::span<const std::byte> bytes) override {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    bool commit() override {
        const std::string actual = sha256Hex(bytes_);
        if (actual != sha256_) {
            throw Error(ErrorCode::unprocessable,
                        "the bytes have the SHA-256 " + actual + ", but were sent as " + sha256_);
        }
        const std::scoped_lock lock(store_.mutex_);
        return store_.blobs_.emplace(sha256_, std::move(bytes_)).second;
    }

private:
    MemoryBlobStore& store_;
    std::string sha256_;
    std::vector<std::byte> bytes_;
};

std::optional<uint64_t> MemoryBlobStore::size(const std::string& sha256) const {
    if (!isSha256Hex(sha256)) throw Error(ErrorCode::invalidArgument, "'" + sha256 + "' is no SHA-256");
    const std::scoped_lock lock(mutex_);
    const auto at = blobs_.find(sha256);
    return at == blobs_.end() ? std::nullopt : std::optional<uint64_t>(at->second.size());
}

std::unique_ptr<BlobWriter> MemoryBlobStore::create(const std::string& sha256) {
    size(sha256);  // checks the name
    return std::make_unique<MemoryBlobWriter>(*this, sha256);
}

void MemoryBlobStore::read(const std::string& sha256, uint64_t offset, std::span<std::byte> into) const {
    const std::scoped_lock lock(mutex_);
    const auto at = blobs_.find(sha256);
    if (at == blobs_.end()) throw Error(ErrorCode::notFound, "there is no blob " + sha256);
    if (offset + into.size() > at->second.size())
        throw Error(ErrorCode::internal, "blob " + sha256 + " ends too early");
    std::copy_n(at->second.begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
}

}  // namespace tilefarm
