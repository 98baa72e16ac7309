#include "worker/agent/uploader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

struct UploaderTest : testing::Test {
    FinishedResult finished(const std::string& id, bool whole = true) {
        const Lease lease = fakeLease(farm, id);
        FinishedResult result;
        result.leaseId = id;
        result.epoch = lease.epoch;
        result.jobId = lease.jobId;
        result.lease = keeper.hold(lease);
        result.deviceSeconds = 2.5;
        result.whole = whole;
        result.image = lease.spec.image;
        FakeBackend backend;
        backend.image = result.image;
        result.films = backend.render(0, std::vector<uint32_t>{0, 1}, {0, 1});
        return result;
    }
    std::vector<std::string> renewedNow() {
        farm.renewed.clear();
        clock.advance(Milliseconds(20'000));
        keeper.renewDue();
        return farm.renewed;
    }
    size_t filesKept() {
        size_t count = 0;
        for (const auto& item : std::filesystem::recursive_directory_iterator(folder.path()))
            count += item.path().extension() == ".result";
        return count;
    }

    TemporaryFolder folder;
    MemoryFarm farm;
    FakeClock clock;
    FakePause pause{clock};
    Standing standing;
    LeaseKeeper keeper{farm, standing, clock};
    ResultQueue queue;
    ResultStore store{folder.path(), "http://farm:1"};
    Uploader uploader{{farm, queue, store, keeper, standing, pause, clock}, 1};
};

TEST_F(UploaderTest, UploadsBitForBitAndLetsGoOfTheLease) {
    FinishedResult result = finished("a");
    const std::vector<PassFilm> films = result.films;
    uploader.settle(std::move(result));
    ASSERT_EQ(farm.uploads.size(), 1u);
    EXPECT_EQ(farm.uploads[0].leaseId, "a");
    EXPECT_EQ(farm.uploads[0].epoch, 5u);
    EXPECT_EQ(farm.uploads[0].deviceSeconds, 2.5);
    ASSERT_EQ(farm.uploads[0].films.size(), 2u);
    for (size_t f = 0; f < 2; ++f)
        EXPECT_EQ(std::memcmp(farm.uploads[0].films[f].pixels.data(), films[f].pixels.data(),
                              films[f].pixels.size() * sizeof(PassPixel)),
                  0);
    EXPECT_THAT(renewedNow(), testing::IsEmpty());
    EXPECT_EQ(filesKept(), 0u);
}

TEST_F(UploaderTest, RunsUntilTheQueueIsClosed) {
    queue.push(finished("a"));
    queue.push(finished("b"));
    queue.close();
    uploader.run();
    EXPECT_EQ(farm.uploads.size(), 2u);
}

TEST_F(UploaderTest, KeepsTheResultOnDiskAndTheLeaseAliveWhileTheServerIsAway) {
    farm.fail(Endpoint::result, ErrorCode::unavailable, 20);
    size_t mostKept = 0;
    pause.onWait = [&] {
        mostKept = std::max(mostKept, filesKept());
        EXPECT_THAT(renewedNow(), testing::ElementsAre("a"));
    };
    uploader.settle(finished("a"));
    EXPECT_EQ(farm.uploads.size(), 1u);
    EXPECT_EQ(mostKept, 1u);
    EXPECT_EQ(filesKept(), 0u);
    EXPECT_EQ(pause.waits.size(), 20u);
    EXPECT_LE(pause.waits.front(), Milliseconds(250));
    EXPECT_LE(pause.waits.back(), Milliseconds(5'000));
    EXPECT_GE(pause.waits.back(), Milliseconds(3'000));
}

TEST_F(UploaderTest, LeavesTheResultOnDiskWhenTheWorkerStopsAndTheNextRunUploadsIt) {
    pause.stopped = true;
    farm.fail(Endpoint::result, ErrorCode::unavailable);
    uploader.settle(finished("a"));
    EXPECT_TRUE(farm.uploads.empty());
    ASSERT_EQ(filesKept(), 1u);

    pause.stopped = false;
    FinishedResult leftBehind;
    for (const auto& item : std::filesystem::recursive_directory_iterator(folder.path()))
        if (item.path().extension() == ".result") leftBehind.file = item.path();
    uploader.settle(std::move(leftBehind));
    ASSERT_EQ(farm.uploads.size(), 1u);
    EXPECT_EQ(farm.uploads[0].leaseId, "a");
    EXPECT_EQ(farm.uploads[0].epoch, 5u);
    EXPECT_EQ(filesKept(), 0u);
}

TEST_F(UploaderTest, DropsAResultThatIsNotNeeded) {
    farm.fail(Endpoint::result, ErrorCode::conflict);
    uploader.settle(finished("a"));
    EXPECT_EQ(farm.calls[Endpoint::result], 1);
    EXPECT_THAT(farm.failures, testing::IsEmpty());
    EXPECT_THAT(renewedNow(), testing::IsEmpty());
}

TEST_F(UploaderTest, DropsEverythingOfAJobThatIsGone) {
    farm.fail(Endpoint::result, ErrorCode::gone);
    uploader.settle(finished("a"));
    EXPECT_TRUE(standing.isGone("job1"));
    uploader.settle(finished("b"));
    EXPECT_EQ(farm.calls[Endpoint::result], 1) << "the second is not even offered";
}

TEST_F(UploaderTest, SaysThatAResultWasRefusedAndDoesNotSendItAgain) {
    farm.fail(Endpoint::result, ErrorCode::unprocessable);
    uploader.settle(finished("a"));
    EXPECT_EQ(farm.calls[Endpoint::result], 1);
    ASSERT_EQ(farm.failures.size(), 1u);
    EXPECT_THAT(farm.failures[0].second, testing::HasSubstr("refused"));
}

TEST_F(UploaderTest, GivesUpOnARequestThatTheServerFailsOnAgainAndAgain) {
    farm.fail(Endpoint::result, ErrorCode::internal, 100);
    uploader.settle(finished("a"));
    EXPECT_EQ(farm.calls[Endpoint::result], 9);
    EXPECT_THAT(farm.handedBack, testing::ElementsAre("a"));
    EXPECT_EQ(filesKept(), 0u);
}

TEST_F(UploaderTest, HoldsLeasingWhileTheServersDiskIsLow) {
    farm.fail(Endpoint::result, ErrorCode::outOfSpace);
    const TimePoint before = clock.now();
    uploader.settle(finished("a"));
    EXPECT_EQ(farm.uploads.size(), 1u);
    EXPECT_GE(standing.leasingHeldUntil(), before + Milliseconds(30'000));
    ASSERT_EQ(pause.waits.size(), 1u);
    EXPECT_GE(pause.waits[0], Milliseconds(10'000));
}

TEST_F(UploaderTest, StopsTheWorkerWhenItsTokenIsRefusedAndKeepsTheResult) {
    farm.fail(Endpoint::result, ErrorCode::unauthorized);
    pause.onWait = [&] { pause.stopped = standing.stopped().has_value(); };
    uploader.settle(finished("a"));
    EXPECT_TRUE(standing.stopped().has_value());
    EXPECT_EQ(filesKept(), 1u);
}

TEST_F(UploaderTest, HandsTheRestOfAPartlyRenderedLeaseBack) {
    uploader.settle(finished("a", false));
    EXPECT_EQ(farm.uploads.size(), 1u);
    EXPECT_THAT(farm.handedBack, testing::ElementsAre("a"));
}

TEST_F(UploaderTest, PassesOverADamagedFileOfAnEarlierRun) {
    FinishedResult damaged;
    damaged.file = folder / "x.result";
    std::ofstream(damaged.file) << "rubbish";
    uploader.settle(std::move(damaged));
    EXPECT_EQ(farm.calls[Endpoint::result], 0);
    EXPECT_EQ(filesKept(), 0u);
}

}  // namespace
}  // namespace tilefarm
