#include <gtest/gtest.h>

#include <fstream>

#include "shared/digest/digest.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

// FIPS 180-2, appendix B, and the empty message.
constexpr const char* kEmpty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* kMillionA = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(Sha256, GivesThePublishedDigests) {
    EXPECT_EQ(sha256Hex(std::string_view("")), kEmpty);
    EXPECT_EQ(sha256Hex(std::string_view("abc")), kAbc);
    EXPECT_EQ(sha256Hex(std::string_view(std::string(1'000'000, 'a'))), kMillionA);
}

TEST(Sha256, DoesNotDependOnHowTheBytesArrive) {
    const std::string message(1'000'000, 'a');
    Sha256 digest;
    for (size_t at = 0, step = 1; at < message.size(); at += step, step = step * 2 + 1) {
        step = std::min(step, message.size() - at);
        digest.update(std::as_bytes(std::span(message.data() + at, step)));
    }
    EXPECT_EQ(digest.finishHex(), kMillionA);
}

TEST(Sha256, ReadsFilesLargerThanItsBlock) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a") << std::string(1'000'000, 'a');
    EXPECT_EQ(sha256OfFile(folder / "a"), kMillionA);
}

TEST(Sha256, NamesTheFileItCannotRead) {
    const TemporaryFolder folder;
    const Error missing = errorOf([&] { sha256OfFile(folder / "absent.bin"); });
    EXPECT_EQ(missing.code, ErrorCode::notFound);
    EXPECT_NE(std::string(missing.what()).find("absent.bin"), std::string::npos);
    EXPECT_EQ(codeOf([&] { sha256OfFile(folder.path()); }), ErrorCode::notFound);
}

TEST(Sha256, KnowsItsOwnSpelling) {
    EXPECT_TRUE(isSha256Hex(kAbc));
    EXPECT_FALSE(isSha256Hex(""));
    EXPECT_FALSE(isSha256Hex(std::string(63, 'a')));
    EXPECT_FALSE(isSha256Hex(std::string(65, 'a')));
    EXPECT_FALSE(isSha256Hex(std::string(64, 'A')));
    EXPECT_FALSE(isSha256Hex(std::string(64, 'g')));
}

}  // namespace
}  // namespace tilefarm
