#include "worker/agent/lease_keeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

struct LeaseKeeperTest : testing::Test {
    Lease lease(const std::string& id, uint32_t renewEveryMs = 10'000) {
        Lease lease = fakeLease(farm, id);
        lease.renewEveryMs = renewEveryMs;
        return lease;
    }

    MemoryFarm farm;
    FakeClock clock;
    Standing standing;
    LeaseKeeper keeper{farm, standing, clock};
};

TEST_F(LeaseKeeperTest, RenewsEveryLeaseWhenItIsDue) {
    keeper.hold(lease("slow", 10'000));
    keeper.hold(lease("fast", 4'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(4'000));
    EXPECT_THAT(farm.renewed, testing::IsEmpty());
    clock.advance(Milliseconds(4'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(4'000));
    clock.advance(Milliseconds(4'000));
    keeper.renewDue();
    clock.advance(Milliseconds(2'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(2'000));
    EXPECT_THAT(farm.renewed, testing::ElementsAre("fast", "fast", "slow"));
}

TEST_F(LeaseKeeperTest, RenewsNoMoreOnceReleased) {
    const auto held = keeper.hold(lease("a"));
    keeper.release(*held);
    clock.advance(Milliseconds(60'000));
    keeper.renewDue();
    EXPECT_THAT(farm.renewed, testing::IsEmpty());
    EXPECT_EQ(held->state, LeaseValidity::valid);
}

TEST_F(LeaseKeeperTest, NotesThatALeaseIsLost) {
    for (const ErrorCode code : {ErrorCode::conflict, ErrorCode::notFound}) {
        const auto held = keeper.hold(lease("a"));
        farm.fail(Endpoint::renew, code);
        clock.advance(Milliseconds(10'000));
        keeper.renewDue();
        EXPECT_EQ(held->state, LeaseValidity::lost);
        EXPECT_FALSE(standing.isGone("job1"));
    }
    clock.advance(Milliseconds(60'000));
    keeper.renewDue();
    EXPECT_EQ(farm.calls[Endpoint::renew], 2) << "a lost lease is not renewed";
}

TEST_F(LeaseKeeperTest, NotesThatAJobIsGone) {
    const auto held = keeper.hold(lease("a"));
    farm.fail(Endpoint::renew, ErrorCode::gone);
    clock.advance(Milliseconds(10'000));
    keeper.renewDue();
    EXPECT_EQ(held->state, LeaseValidity::jobGone);
    EXPECT_TRUE(standing.isGone("job1"));
}

TEST_F(LeaseKeeperTest, TriesAgainSoonWhileTheServerIsAway) {
    const auto held = keeper.hold(lease("a"));
    farm.fail(Endpoint::renew, ErrorCode::unavailable, 2);
    clock.advance(Milliseconds(10'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(2'000));
    clock.advance(Milliseconds(2'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(2'000));
    clock.advance(Milliseconds(2'000));
    EXPECT_EQ(keeper.renewDue(), Milliseconds(10'000));
    EXPECT_THAT(farm.renewed, testing::ElementsAre("a"));
    EXPECT_EQ(held->state, LeaseValidity::valid);
}

TEST_F(LeaseKeeperTest, StopsTheWorkerWhenItsTokenIsNoLongerTaken) {
    keeper.hold(lease("a"));
    farm.fail(Endpoint::renew, ErrorCode::unauthorized);
    clock.advance(Milliseconds(10'000));
    keeper.renewDue();
    EXPECT_TRUE(standing.stopped().has_value());
}

TEST_F(LeaseKeeperTest, ItsThreadNoticesALeaseAtOnceAndEndsWhenTold) {
    const SystemClock real;
    LeaseKeeper running(farm, standing, real);
    std::thread thread([&] { running.run(); });
    running.hold(lease("a", 1));
    while (true) {
        const std::lock_guard lock(farm.mutex);
        if (!farm.renewed.empty()) break;
    }
    running.end();
    thread.join();
}

}  // namespace
}  // namespace tilefarm
