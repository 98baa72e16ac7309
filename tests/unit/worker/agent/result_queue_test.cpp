#include "worker/agent/result_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace tilefarm {
namespace {

FinishedResult result(const std::string& id, size_t pixels = 64) {
    FinishedResult result;
    result.leaseId = id;
    result.films = {{0, {0, 0, 8, 8}, {0, 1}, std::vector<PassPixel>(pixels)}};
    return result;
}

TEST(ResultQueue, GivesResultsOutInTheirOrderAndThenEnds) {
    ResultQueue queue;
    queue.push(result("a"));
    queue.push(result("b"));
    queue.close();
    EXPECT_EQ(queue.take()->leaseId, "a");
    EXPECT_EQ(queue.take()->leaseId, "b");
    EXPECT_FALSE(queue.take().has_value());
}

TEST(ResultQueue, AThirdResultWaitsForRoom) {
    ResultQueue queue;
    queue.push(result("a"));
    queue.push(result("b"));
    std::atomic<bool> pushed = false;
    std::thread pushing([&] {
        queue.push(result("c"));
        pushed = true;
    });
    EXPECT_EQ(queue.size(), 2u);
    EXPECT_FALSE(pushed);
    EXPECT_EQ(queue.take()->leaseId, "a");
    pushing.join();
    EXPECT_EQ(queue.size(), 2u);
}

TEST(ResultQueue, ResultsOnDiskTakeNoRoom) {
    ResultQueue queue;
    for (int i = 0; i < 100; ++i) {
        FinishedResult onDisk;
        onDisk.file = "x.result";
        queue.push(std::move(onDisk));
    }
    EXPECT_EQ(queue.size(), 100u);
}

}  // namespace
}  // namespace tilefarm
