#include "worker/agent/backoff.h"

#include <gtest/gtest.h>

#include "worker/agent/pause.h"

namespace tilefarm {
namespace {

TEST(Backoff, DoublesUpToAMostWithinAQuarter) {
    Backoff backoff(Milliseconds(100), Milliseconds(1000), 7);
    for (const int expected : {100, 200, 400, 800, 1000, 1000, 1000}) {
        const auto wait = backoff.next().count();
        EXPECT_LE(wait, expected);
        EXPECT_GE(wait, expected * 3 / 4);
    }
}

TEST(Backoff, StartsAnewAfterReset) {
    Backoff backoff(Milliseconds(100), Milliseconds(1000), 7);
    for (int i = 0; i < 100; ++i) backoff.next();
    EXPECT_EQ(backoff.failures(), 100u);
    backoff.reset();
    EXPECT_LE(backoff.next().count(), 100);
}

TEST(Backoff, WorkersOfAFarmDoNotComeBackTogether) {
    Backoff one(Milliseconds(10'000), Milliseconds(10'000), 1),
        other(Milliseconds(10'000), Milliseconds(10'000), 2);
    EXPECT_NE(one.next(), other.next());
}

TEST(StopSwitch, EndsEveryWait) {
    StopSwitch stop;
    EXPECT_FALSE(stop.stopping());
    stop.stop();
    EXPECT_TRUE(stop.stopping());
    stop.waitFor(Milliseconds(1'000'000'000));  // hangs here if it does not
}

}  // namespace
}  // namespace tilefarm
