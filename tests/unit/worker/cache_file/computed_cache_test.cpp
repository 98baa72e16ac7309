#include "worker/cache_file/computed_cache.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/temporary_folder.h"
#include "worker/cache_file/cache_file.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

class ComputedCacheTest : public testing::Test {
protected:
    Bytes ask(uint8_t key, size_t size = 100, uint64_t mostBytes = 1 << 20) {
        const std::byte bytes[]{std::byte{key}};
        return computedOnce({folder_.path(), mostBytes}, "test", bytes, [&] {
            ++computed_;
            return Bytes(size, std::byte{key});
        });
    }

    std::vector<fs::path> files() const {
        return {fs::directory_iterator(folder_.path()), fs::directory_iterator()};
    }

    TemporaryFolder folder_;
    int computed_ = 0;
};

TEST_F(ComputedCacheTest, ComputesOnceForEachKey) {
    EXPECT_EQ(ask(1), Bytes(100, std::byte{1}));
    EXPECT_EQ(ask(2), Bytes(100, std::byte{2}));
    EXPECT_EQ(ask(1), Bytes(100, std::byte{1}));
    EXPECT_EQ(computed_, 2);
    EXPECT_EQ(files().size(), 2u);
}

TEST_F(ComputedCacheTest, KindsAreApart) {
    ask(1);
    const std::byte key[]{std::byte{1}};
    const Bytes other = computedOnce({folder_.path()}, "other", key, [] { return Bytes(3); });
    EXPECT_EQ(other, Bytes(3));
}

TEST_F(ComputedCacheTest, ComputesAnewWhatIsTornOrAltered) {
    ask(1);
    const fs::path file = files().at(0);
    for (const uintmax_t size : {fs::file_size(file) - 1, uintmax_t{3}, uintmax_t{0}}) {
        const int before = computed_;
        fs::resize_file(file, size);
        EXPECT_EQ(ask(1), Bytes(100, std::byte{1})) << size;
        EXPECT_EQ(computed_, before + 1) << size;
    }
    Bytes altered = readCacheFile(file);
    fs::resize_file(file, fs::file_size(file) - 1);
    fs::resize_file(file, fs::file_size(file) + 1);  // the last byte is 0 now
    EXPECT_EQ(ask(1), altered);
    EXPECT_EQ(computed_, 5);
}

TEST_F(ComputedCacheTest, DropsWhatWasUsedLeastRecently) {
    ask(1);
    const fs::path first = files().at(0);
    ask(2);
    for (const fs::path& file : files())
        fs::last_write_time(file,
                            fs::file_time_type::clock::now() - std::chrono::hours(file == first ? 2 : 1));
    ask(1);  // is used again
    ask(3, 100, 250);
    EXPECT_EQ(files().size(), 2u);
    EXPECT_TRUE(fs::exists(first));
}

TEST_F(ComputedCacheTest, LeavesOtherFilesAlone) {
    writeCacheFile(folder_ / "pipelines.bin", Bytes(10));
    EXPECT_EQ(ask(1, 100, 1).size(), 100u);  // too large even by itself
    ASSERT_EQ(files().size(), 1u);
    EXPECT_EQ(files()[0].filename(), "pipelines.bin");
}

TEST_F(ComputedCacheTest, KeepsNoEmptyResult) {
    EXPECT_TRUE(ask(1, 0).empty());
    EXPECT_TRUE(ask(1, 0).empty());
    EXPECT_EQ(computed_, 2);
    EXPECT_TRUE(files().empty());
}

TEST(ComputedCache, AFolderThatCannotBeWrittenCostsTimeAlone) {
    for (const char* folder : {"", "/proc/nowhere"})
        EXPECT_EQ(computedOnce({folder}, "test", {}, [] { return Bytes(7); }), Bytes(7));
}

}  // namespace
}  // namespace tilefarm
