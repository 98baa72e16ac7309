#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace tilefarm {

/// Takes one blob's bytes piece by piece. Dropped without `commit`, nothing is kept.
struct BlobWriter {
    virtual ~BlobWriter() = default;
    virtual void write(std::span<const std::byte> bytes) = 0;
    /// Keeps the blob durably; true if it was not there before. Throws Error(unprocessable) that names
    /// both digests if the bytes are not those of the name; nothing is kept then.
    virtual bool commit() = 0;
};

/// Bytes named by their SHA-256 (64 lower-case hex digits). A blob is whole and right or absent.
/// Any thread may call.
struct BlobStore {
    virtual ~BlobStore() = default;
    /// Bytes, or nothing if it is not there.
    virtual std::optional<uint64_t> size(const std::string& sha256) const = 0;
    virtual std::unique_ptr<BlobWriter> create(const std::string& sha256) = 0;
    /// Fills `into` from `offset`. Throws Error(notFound) for an absent blob.
    virtual void read(const std::string& sha256, uint64_t offset, std::span<std::byte> into) const = 0;
};

}  // namespace tilefarm
