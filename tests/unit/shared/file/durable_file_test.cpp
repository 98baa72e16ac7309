#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>
#include <sstream>

#include "shared/file/durable_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;

std::string textOf(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

size_t filesIn(const fs::path& folder) {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(DurableFile, AppearsWholeOnCommitOnly) {
    const TemporaryFolder folder;
    DurableFile file(folder / "a");
    file.write("hello ");
    EXPECT_FALSE(fs::exists(folder / "a"));
    file.write("world");
    file.commit();
    EXPECT_EQ(textOf(folder / "a"), "hello world");
    EXPECT_EQ(filesIn(folder.path()), 1u);
}

TEST(DurableFile, LeavesNothingBehindWithoutCommit) {
    const TemporaryFolder folder;
    {
        DurableFile file(folder / "a");
        file.write(std::string(1'000'000, 'x'));
        EXPECT_EQ(filesIn(folder.path()), 1u);
    }
    EXPECT_EQ(filesIn(folder.path()), 0u);
}

TEST(DurableFile, MarksWhatIsUnfinishedByItsName) {
    const TemporaryFolder folder;
    const DurableFile file(folder / "a");
    for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_TRUE(entry.path().string().ends_with(kUnfinishedSuffix)) << entry.path();
}

TEST(DurableFile, ReplacesAFileAndKeepsItUntilThen) {
    const TemporaryFolder folder;
    writeDurably(folder / "a", "old");
    DurableFile file(folder / "a");
    file.write("new");
    EXPECT_EQ(textOf(folder / "a"), "old");
    file.commit();
    EXPECT_EQ(textOf(folder / "a"), "new");
}

TEST(DurableFile, SeeksBackToOverwrite) {
    const TemporaryFolder folder;
    DurableFile file(folder / "a");
    file.write("0000 table");
    file.seek(0);
    file.write("1234");
    EXPECT_EQ(file.position(), 4u);
    file.seek(10);
    file.write("!");
    file.commit();
    EXPECT_EQ(textOf(folder / "a"), "1234 table!");
}

TEST(DurableFile, TwoWritersOfOnePathDoNotMix) {
    const TemporaryFolder folder;
    DurableFile first(folder / "a"), second(folder / "a");
    first.write("first");
    second.write("second");
    first.commit();
    second.commit();
    EXPECT_EQ(textOf(folder / "a"), "second");
}

TEST(DurableFile, NamesTheFolderThatIsMissing) {
    const TemporaryFolder folder;
    const Error error = errorOf([&] { writeDurably(folder / "no/such/a.exr", "x"); });
    EXPECT_EQ(error.code, ErrorCode::notFound);
    EXPECT_NE(std::string(error.what()).find("no/such/a.exr"), std::string::npos);
}

TEST(DurableFile, SaysOutOfSpaceWhenTheSystemTakesNoMoreBytes) {
    const TemporaryFolder folder;
    // A size limit stands in for a full disk: the same path, a write that the kernel refuses.
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_IGN);
    const rlimit small{64 * 1024, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Error error = errorOf([&] { writeDurably(folder / "big.exr", std::string(1'000'000, 'x')); });
    setrlimit(RLIMIT_FSIZE, &before);

    EXPECT_EQ(error.code, ErrorCode::outOfSpace);
    EXPECT_NE(std::string(error.what()).find("big.exr"), std::string::npos);
    EXPECT_EQ(filesIn(folder.path()), 0u);
}

TEST(FileError, TurnsAFullDiskIntoOutOfSpace) {
    EXPECT_EQ(fileError("write", "a", ENOSPC).code, ErrorCode::outOfSpace);
    EXPECT_EQ(fileError("write", "a", EDQUOT).code, ErrorCode::outOfSpace);
    EXPECT_EQ(fileError("write", "a", EIO).code, ErrorCode::internal);
}

TEST(ReadWhole, GivesTheBytesUpToALimit) {
    const TemporaryFolder folder;
    writeDurably(folder / "a", "12345");
    EXPECT_EQ(readWhole(folder / "a", 5).size(), 5u);
    EXPECT_EQ(codeOf([&] { readWhole(folder / "a", 4); }), ErrorCode::tooLarge);
    EXPECT_EQ(codeOf([&] { readWhole(folder / "b"); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { readWhole(folder.path()); }), ErrorCode::internal);
}

}  // namespace
}  // namespace tilefarm
