#include <gtest/gtest.h>

#include <fstream>

#include "server/store/file_blob_store.h"
#include "shared/digest/digest.h"
#include "tests/contract/backend_name.h"
#include "tests/support/expect_error.h"
#include "tests/support/memory_blob_store.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using MakeBlobs = std::function<std::unique_ptr<BlobStore>(const TemporaryFolder&)>;

class BlobStoreContract : public testing::TestWithParam<MakeBlobs> {
protected:
    static std::span<const std::byte> bytesOf(const std::string& content) {
        return std::as_bytes(std::span(content));
    }
    bool put(const std::string& sha256, const std::string& content) {
        const auto writer = blobs->create(sha256);
        for (const char& c : content) writer->write(std::as_bytes(std::span(&c, 1)));
        return writer->commit();
    }
    std::string get(const std::string& sha256, uint64_t offset, size_t bytes) {
        std::string content(bytes, '?');
        blobs->read(sha256, offset, std::as_writable_bytes(std::span(content)));
        return content;
    }

    TemporaryFolder folder;
    std::unique_ptr<BlobStore> blobs = GetParam()(folder);
    const std::string text = "tiles and passes", name = sha256Hex(text);
};

TEST_P(BlobStoreContract, GivesBackWhatWasPutPieceByPiece) {
    EXPECT_TRUE(put(name, text));
    EXPECT_EQ(blobs->size(name), text.size());
    EXPECT_EQ(get(name, 0, text.size()), text);
    EXPECT_EQ(get(name, 6, 3), "and");
}

TEST_P(BlobStoreContract, SaysThatABlobWasThereBefore) {
    EXPECT_TRUE(put(name, text));
    EXPECT_FALSE(put(name, text));
    EXPECT_EQ(get(name, 0, text.size()), text);
}

TEST_P(BlobStoreContract, RefusesBytesOfAnotherDigestAndKeepsNothing) {
    const Error error = errorOf([&] { put(name, "other bytes"); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
    EXPECT_EQ(blobs->size(name), std::nullopt);
}

TEST_P(BlobStoreContract, RefusesOtherBytesForABlobThatIsThere) {
    put(name, text);
    EXPECT_EQ(codeOf([&] { put(name, "other bytes"); }), ErrorCode::unprocessable);
    EXPECT_EQ(get(name, 0, text.size()), text);
}

TEST_P(BlobStoreContract, ForgetsWhatWasNotCommitted) {
    blobs->create(name)->write(bytesOf(text));
    EXPECT_EQ(blobs->size(name), std::nullopt);
    EXPECT_EQ(codeOf([&] { get(name, 0, 1); }), ErrorCode::notFound);
}

TEST_P(BlobStoreContract, RefusesNamesThatAreNoDigest) {
    for (const std::string bad : {"", "abc", "../../etc/passwd"}) {
        EXPECT_EQ(codeOf([&] { blobs->size(bad); }), ErrorCode::invalidArgument) << bad;
        EXPECT_EQ(codeOf([&] { blobs->create(bad); }), ErrorCode::invalidArgument) << bad;
    }
}

TEST_P(BlobStoreContract, KeepsAnEmptyBlob) {
    EXPECT_TRUE(put(sha256Hex(std::string_view{}), ""));
    EXPECT_EQ(blobs->size(sha256Hex(std::string_view{})), 0u);
}

INSTANTIATE_TEST_SUITE_P(Memory, BlobStoreContract, testing::Values([](const TemporaryFolder&) {
                             return std::make_unique<MemoryBlobStore>();
                         }),
                         backendName("Memory"));
INSTANTIATE_TEST_SUITE_P(Files, BlobStoreContract, testing::Values([](const TemporaryFolder& folder) {
                             return std::make_unique<FileBlobStore>(folder / "blobs");
                         }),
                         backendName("Files"));

TEST(FileBlobStore, KeepsBlobsOverAReopenAndRemovesUnfinishedOnes) {
    const TemporaryFolder folder;
    const std::string text = "kept", name = sha256Hex(text);
    {
        FileBlobStore blobs(folder / "blobs");
        const auto writer = blobs.create(name);
        writer->write(std::as_bytes(std::span(text)));
        writer->commit();
    }
    const auto unfinished = folder / ("blobs/" + name.substr(0, 2) + "/.x.unfinished");
    std::ofstream(unfinished) << "half";
    const FileBlobStore blobs(folder / "blobs");
    EXPECT_EQ(blobs.size(name), text.size());
    EXPECT_FALSE(std::filesystem::exists(unfinished));
}

}  // namespace
}  // namespace tilefarm
