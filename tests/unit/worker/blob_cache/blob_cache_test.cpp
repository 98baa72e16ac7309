#include <atomic>
#include <thread>
#include <vector>

#include "tests/unit/worker/blob_cache/blob_fixture.h"

namespace tilefarm {
namespace {

using BlobCacheTest = BlobFixture;
constexpr uint64_t kPlenty = 1 << 20;

TEST_F(BlobCacheTest, FetchesABlobOnceAndHandsItOutUnderAnyName) {
    BlobCache cache(folder / "cache", kPlenty);
    const std::string sha256 = add("one");
    cache.link(sha256, folder / "a", source());
    cache.link(sha256, folder.path() / "deep" / "er" / "b", source());
    EXPECT_EQ(read(folder / "a"), "one");
    EXPECT_EQ(read(folder.path() / "deep" / "er" / "b"), "one");
    EXPECT_EQ(fetches[sha256], 1);
    EXPECT_EQ(cache.bytes(), 3u);
}

TEST_F(BlobCacheTest, KeepsBlobsFromRunToRun) {
    const std::string sha256 = add("kept");
    BlobCache(folder / "cache", kPlenty).link(sha256, folder / "a", source());
    BlobCache again(folder / "cache", kPlenty);
    EXPECT_EQ(again.bytes(), 4u);
    again.link(sha256, folder / "b", source());
    EXPECT_EQ(read(folder / "b"), "kept");
    EXPECT_EQ(fetches[sha256], 1);
}

TEST_F(BlobCacheTest, FetchesAgainWhatWentBadOnTheDisk) {
    const std::string sha256 = add("precious");
    BlobCache(folder / "cache", kPlenty).link(sha256, folder / "a", source());
    std::filesystem::remove(folder / "a");
    std::ofstream(blobFile(sha256), std::ios::binary) << "precioux";  // same length, one bit rotten
    BlobCache again(folder / "cache", kPlenty);
    again.link(sha256, folder / "b", source());
    EXPECT_EQ(read(folder / "b"), "precious");
    EXPECT_EQ(read(blobFile(sha256)), "precious");
    EXPECT_EQ(fetches[sha256], 2);
}

TEST_F(BlobCacheTest, FetchesAgainWhatSomebodyRemovedWhileItRan) {
    const std::string sha256 = add("here today");
    BlobCache cache(folder / "cache", kPlenty);
    cache.link(sha256, folder / "a", source());
    std::filesystem::remove(blobFile(sha256));
    cache.link(sha256, folder / "b", source());
    EXPECT_EQ(read(folder / "b"), "here today");
    EXPECT_EQ(cache.bytes(), 10u);
}

TEST_F(BlobCacheTest, ThrowsOutWhatWasNotUsedForLongest) {
    BlobCache cache(folder / "cache", 10);
    const std::string first = add("1111"), second = add("2222"), third = add("3333");
    cache.link(first, folder / "1", source());
    cache.link(second, folder / "2", source());
    cache.link(first, folder / "1 again", source());
    cache.link(third, folder / "3", source());
    EXPECT_TRUE(std::filesystem::exists(blobFile(first)));
    EXPECT_FALSE(std::filesystem::exists(blobFile(second)));
    EXPECT_EQ(cache.bytes(), 8u);
    EXPECT_EQ(read(folder / "2"), "2222") << "what was handed out stays";
}

TEST_F(BlobCacheTest, RemembersTheOrderOfUseFromRunToRun) {
    const std::string first = add("1111"), second = add("2222"), third = add("3333");
    {
        BlobCache cache(folder / "cache", kPlenty);
        cache.link(first, folder / "1", source());
        cache.link(second, folder / "2", source());
    }
    const auto now = std::filesystem::file_time_type::clock::now();
    std::filesystem::last_write_time(blobFile(first), now - std::chrono::hours(1));
    std::filesystem::last_write_time(blobFile(second), now - std::chrono::hours(2));
    BlobCache cache(folder / "cache", 10);
    cache.link(third, folder / "3", source());
    EXPECT_TRUE(std::filesystem::exists(blobFile(first)));
    EXPECT_FALSE(std::filesystem::exists(blobFile(second)));
}

TEST_F(BlobCacheTest, KeepsTheOneInUseEvenIfItAloneIsTooMuch) {
    BlobCache cache(folder / "cache", 2);
    const std::string big = add("bigger than the limit");
    cache.link(big, folder / "a", source());
    cache.link(big, folder / "b", source());
    EXPECT_EQ(fetches[big], 1);
}

TEST_F(BlobCacheTest, AsksTwiceWhenABlobArrivesDamaged) {
    BlobCache cache(folder / "cache", kPlenty);
    const std::string sha256 = add("fine");
    spoilt = 1;
    cache.link(sha256, folder / "a", source());
    EXPECT_EQ(read(folder / "a"), "fine");
    EXPECT_EQ(fetches[sha256], 2);
}

TEST_F(BlobCacheTest, NeverKeepsABlobOfAnotherDigest) {
    BlobCache cache(folder / "cache", kPlenty);
    const std::string sha256 = add("fine");
    spoilt = 2;
    const Error error = errorOf([&] { cache.link(sha256, folder / "a", source()); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_THAT(error.what(), testing::HasSubstr(sha256));
    EXPECT_FALSE(std::filesystem::exists(blobFile(sha256)));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache" / "incoming"));
}

TEST_F(BlobCacheTest, PassesTheSourcesErrorOnAndTriesAnewNextTime) {
    BlobCache cache(folder / "cache", kPlenty);
    const std::string sha256 = sha256Hex(std::string_view("later"));
    EXPECT_EQ(codeOf([&] { cache.link(sha256, folder / "a", source()); }), ErrorCode::notFound);
    add("later");
    cache.link(sha256, folder / "a", source());
    EXPECT_EQ(read(folder / "a"), "later");
}

TEST_F(BlobCacheTest, RefusesWhatIsNoDigest) {
    BlobCache cache(folder / "cache", kPlenty);
    EXPECT_EQ(codeOf([&] { cache.link("../../etc/passwd", folder / "a", source()); }),
              ErrorCode::invalidArgument);
}

TEST_F(BlobCacheTest, FetchesOnceForManyThreads) {
    BlobCache cache(folder / "cache", kPlenty);
    const std::string sha256 = add("shared");
    std::atomic<int> count = 0;
    const BlobSource slow = [&](const std::string&, const std::filesystem::path& file) {
        ++count;
        std::this_thread::yield();
        std::ofstream(file) << "shared";
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&, i] { cache.link(sha256, folder / std::to_string(i), slow); });
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(count, 1);
    for (int i = 0; i < 8; ++i) EXPECT_EQ(read(folder / std::to_string(i)), "shared");
}

}  // namespace
}  // namespace tilefarm
