#include "server/housekeeper.h"

#include "tests/unit/server/api/api_fixture.h"

namespace tilefarm {
namespace {

TEST_F(ApiTest, FinishesFramesByItselfOnceWoken) {
    Housekeeper keeper(*farm.scheduler, *farm.images, metrics);
    const std::string id = submit()["id"];
    upload(leaseFromJson(parsed(askForWork())));
    keeper.wake();
    while (farm.job(id).state != JobState::completed) std::this_thread::yield();
    EXPECT_EQ(farm.frame(id).state, FrameState::completed);
}

}  // namespace
}  // namespace tilefarm
