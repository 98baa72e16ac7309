#include "server/queue/worker_roster.h"

#include <gtest/gtest.h>

#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

constexpr TimePoint kNow{Milliseconds{1'700'000'000'000}};
constexpr Milliseconds kOnline{60000};

TEST(WorkerRoster, KnowsWhoIsOnline) {
    WorkerRoster roster(kOnline, {});
    roster.seen(hello("a"), kNow);
    roster.seen(hello("b"), kNow + kOnline / 2);
    EXPECT_FALSE(roster.onlineElsewhere({"host"}, kNow));
    EXPECT_TRUE(roster.onlineElsewhere({"another"}, kNow));
    EXPECT_EQ(roster.online(kNow + kOnline / 2), 2u);
    EXPECT_EQ(roster.online(kNow + kOnline), 1u);
    EXPECT_EQ(roster.list(kNow + kOnline)[0].state, WorkerState::offline);
    roster.seen("a", kNow + kOnline);
    EXPECT_EQ(roster.online(kNow + kOnline), 2u);
}

TEST(WorkerRoster, AsksToBeStoredOnlyWhenItMatters) {
    WorkerRoster roster(kOnline, {});
    EXPECT_TRUE(roster.seen(hello("a"), kNow));
    EXPECT_FALSE(roster.seen(hello("a"), kNow + Milliseconds(500)));
    WorkerHello changed = hello("a");
    changed.driver = "newer";
    EXPECT_TRUE(roster.seen(changed, kNow + Milliseconds(600)));
    EXPECT_TRUE(roster.seen(changed, kNow + Milliseconds(120000)));
}

TEST(WorkerRoster, AveragesSpeedPerJobTowardsTheNewest) {
    WorkerRoster roster(kOnline, {});
    EXPECT_EQ(roster.rate("a", 1), 0);
    roster.measured("a", 1, 100, 1);
    EXPECT_EQ(roster.rate("a", 1), 100);
    for (int i = 0; i < 10; ++i) roster.measured("a", 1, 900, 1);
    EXPECT_NEAR(roster.rate("a", 1), 900, 1);
    EXPECT_EQ(roster.rate("a", 2), 0);
    roster.measured("a", 1, 900, 0);  // says nothing
    EXPECT_NEAR(roster.lastRate("a"), 900, 1);
}

TEST(WorkerRoster, DoesNotCountQuarantinedWorkers) {
    WorkerRow row{hello("a"), WorkerState::quarantined, "why", kNow, kNow};
    WorkerRoster roster(kOnline, {row});
    roster.seen(hello("a"), kNow);
    EXPECT_EQ(roster.online(kNow), 0u);
    EXPECT_EQ(roster.list(kNow)[0].state, WorkerState::quarantined);
}

}  // namespace
}  // namespace tilefarm
