#include "server/store/file_blob_store.h"

#include "server/store/file.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;

class FileBlobWriter : public BlobWriter {
public:
    FileBlobWriter(const fs::path& path, std::string sha256)
        : present_(fs::exists(path)), sha256_(std::move(sha256)), file_(path) {}

    void write(std::span<const std::byte> bytes) override {
        digest_.update(bytes);
        if (!present_) file_.write(bytes);
    }
    bool commit() override {
        const std::string actual = digest_.finishHex();
        if (actual != sha256_) {
            throw Error(ErrorCode::unprocessable,
                        "the bytes have the SHA-256 " + actual + ", but were sent as " + sha256_);
        }
        if (!present_) file_.commit();
        return !present_;
    }

private:
    bool present_;
    std::string sha256_;
    DurableFile file_;
    Sha256 digest_;
};

void removeUnfinished(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.path().filename().string().ends_with(kUnfinishedSuffix)) fs::remove(entry.path());
    }
}

}  // namespace

FileBlobStore::FileBlobStore(fs::path folder) : folder_(std::move(folder)) {
    makeFolder(folder_);
    removeUnfinished(folder_);
}

fs::path FileBlobStore::pathOf(const std::string& sha256) const {
    if (!isSha256Hex(sha256)) throw Error(ErrorCode::invalidArgument, "'" + sha256 + "' is no SHA-256");
    return folder_ / sha256.substr(0, 2) / sha256;
}

std::optional<uint64_t> FileBlobStore::size(const std::string& sha256) const {
    std::error_code fault;
    const auto size = fs::file_size(pathOf(sha256), fault);
    return fault ? std::nullopt : std::optional<uint64_t>(size);
}

std::unique_ptr<BlobWriter> FileBlobStore::create(const std::string& sha256) {
    const auto path = pathOf(sha256);
    makeFolder(path.parent_path());
    return std::make_unique<FileBlobWriter>(path, sha256);
}

void FileBlobStore::read(const std::string& sha256, uint64_t offset, std::span<std::byte> into) const {
    if (!size(sha256)) throw Error(ErrorCode::notFound, "there is no blob " + sha256);
    File(pathOf(sha256), File::Mode::read).readAt(offset, into);
}

}  // namespace tilefarm
