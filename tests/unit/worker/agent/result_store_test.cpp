#include "worker/agent/result_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "shared/digest/digest.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

StoredResult sample(const std::string& lease) {
    StoredResult result{lease, 7, "job1", 1.25, false, {}, {}};
    for (int i = 0; i < 1000; ++i) result.exr.push_back(static_cast<std::byte>(i % 251));
    result.sha256 = sha256Hex(result.exr);
    return result;
}

TEST(ResultStore, GivesBackWhatItWasGiven) {
    const TemporaryFolder folder;
    ResultStore store(folder.path(), "http://farm:1");
    const StoredResult read = store.load(store.save(sample("a")));
    const StoredResult expected = sample("a");
    EXPECT_EQ(read.leaseId, expected.leaseId);
    EXPECT_EQ(read.epoch, expected.epoch);
    EXPECT_EQ(read.jobId, expected.jobId);
    EXPECT_EQ(read.deviceSeconds, expected.deviceSeconds);
    EXPECT_EQ(read.whole, expected.whole);
    EXPECT_EQ(read.sha256, expected.sha256);
    EXPECT_EQ(read.exr, expected.exr);
}

TEST(ResultStore, LeavesNothingBehindOnceAllIsUploaded) {
    const TemporaryFolder folder;
    {
        ResultStore store(folder.path(), "http://farm:1");
        store.remove(store.save(sample("a")));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ResultStore, TellsProcessesThatWereKilledFromThoseThatEnded) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "killed");  // what one leaves: its lock is nobody's any more
    for (const char* file : {"killed/lock", "killed/at-work"}) std::ofstream(folder / file).flush();
    {
        ResultStore ended(folder.path(), "http://farm:1");
        ended.save(sample("a"));  // could not be uploaded before it ended
    }
    const ResultStore running(folder.path(), "http://farm:1");
    ResultStore store(folder.path(), "http://farm:1");
    EXPECT_NE(store.session(), running.session());
    EXPECT_EQ(store.adopt().size(), 1u);
    EXPECT_THAT(store.crashed(), testing::ElementsAre("killed"));
    ResultStore later(folder.path(), "http://farm:1");
    later.adopt();
    EXPECT_THAT(later.crashed(), testing::IsEmpty());  // told once
}

TEST(ResultStore, TakesOverWhatAnEndedProcessLeftForTheSameServer) {
    const TemporaryFolder folder;
    {
        ResultStore ended(folder.path(), "http://farm:1"), other(folder.path(), "http://other:1");
        ended.save(sample("a"));
        ended.save(sample("b"));
        other.save(sample("c"));
    }
    ResultStore store(folder.path(), "http://farm:1");
    const auto adopted = store.adopt();
    ASSERT_EQ(adopted.size(), 2u);
    EXPECT_EQ(store.load(adopted[0]).leaseId, "a");
    EXPECT_EQ(store.load(adopted[1]).leaseId, "b");
    EXPECT_TRUE(ResultStore(folder.path(), "http://other:1").adopt().size() == 1);
}

TEST(ResultStore, LeavesARunningProcessItsOwn) {
    const TemporaryFolder folder;
    ResultStore running(folder.path(), "http://farm:1");
    const auto file = running.save(sample("a"));
    ResultStore store(folder.path(), "http://farm:1");
    EXPECT_THAT(store.adopt(), testing::IsEmpty());
    EXPECT_EQ(running.load(file).leaseId, "a");
}

TEST(ResultStore, NoticesDamage) {
    const TemporaryFolder folder;
    ResultStore store(folder.path(), "http://farm:1");
    const auto file = store.save(sample("a"));
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(-1, std::ios::end) << 'x';
    EXPECT_EQ(codeOf([&] { store.load(file); }), ErrorCode::unprocessable);
    std::ofstream(file) << "{}\n";
    EXPECT_EQ(codeOf([&] { store.load(file); }), ErrorCode::unprocessable);
    std::ofstream(file) << "";
    EXPECT_EQ(codeOf([&] { store.load(file); }), ErrorCode::unprocessable);
}

TEST(ResultStore, ThrowsAwayFilesThatAreNoResults) {
    const TemporaryFolder folder;
    std::filesystem::path rubbish;
    {
        ResultStore ended(folder.path(), "http://farm:1");
        rubbish = ended.save(sample("a"));
        std::ofstream(rubbish) << "rubbish";
    }
    ResultStore store(folder.path(), "http://farm:1");
    EXPECT_THAT(store.adopt(), testing::IsEmpty());
    EXPECT_FALSE(std::filesystem::exists(rubbish.parent_path()));
}

}  // namespace
}  // namespace tilefarm
