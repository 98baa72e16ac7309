#include "worker/agent/fleet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/support/temporary_folder.h"
#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

// With real threads; ended by the fake server once it has nothing left.
struct FleetTest : testing::Test {
    FleetParts parts() {
        return {[this] { return std::make_unique<SharedFarm>(farm); },
                cache,
                store,
                stop,
                clock,
                "host",
                "0.1.0",
                5,
                1};
    }
    static FleetMember member(const std::string& name) {
        return {name, [] { return std::make_unique<FakeBackend>(); }};
    }

    TemporaryFolder folder;
    MemoryFarm farm;
    SystemClock clock;
    StopSwitch stop;
    BlobCache cache{folder / "cache", 1 << 20};
    ResultStore store{folder / "results", "http://farm:1"};
};

TEST_F(FleetTest, ThreeDevicesUploadEveryLeaseOnce) {
    std::set<std::string> expected, uploaded;
    for (int i = 0; i < 30; ++i) {
        farm.leases.push_back(fakeLease(farm, "lease" + std::to_string(i)));
        expected.insert(farm.leases.back().id);
    }
    farm.retryAfterMs = 1;
    farm.onIdle = [this] {
        if (farm.uploads.size() == 30) stop.stop();  // earlier, a lease might be handed back instead
    };
    EXPECT_THAT(runFleet(parts(), {member("a"), member("b"), member("c")}), testing::IsEmpty());
    for (const auto& upload : farm.uploads) {
        EXPECT_TRUE(uploaded.insert(upload.leaseId).second);
        EXPECT_EQ(upload.films.size(), 5u);
    }
    EXPECT_EQ(uploaded, expected);
}

TEST_F(FleetTest, StopsWhenTheServerRefusesItAndSaysWhy) {
    farm.fail(Endpoint::lease, ErrorCode::versionRefused);
    EXPECT_THAT(runFleet(parts(), {member("a"), member("b")}),
                testing::ElementsAre(testing::HasSubstr("the server says no")));
}

TEST_F(FleetTest, ADeviceThatDoesNotOpenLeavesTheOthersWorking) {
    farm.leases.push_back(fakeLease(farm, "a"));
    farm.onIdle = [this] { stop.stop(); };
    const FleetMember broken{"broken", []() -> std::unique_ptr<RenderBackend> {
                                 throw Error(ErrorCode::notFound, "there is no device 7");
                             }};
    EXPECT_THAT(runFleet(parts(), {broken, member("b")}), testing::ElementsAre("there is no device 7"));
    EXPECT_EQ(farm.uploads.size(), 1u);
}

TEST_F(FleetTest, UploadsWhatAnEarlierRunLeftBehind) {
    {
        ResultStore ended(folder / "results", "http://farm:1");
        FakeBackend backend;
        backend.image = {16, 8, 8};
        StoredResult result{"old", 3, "job0", 1, true, {}, {}};
        result.exr = encodePassFilms(backend.render(0, std::vector<uint32_t>{0}, {0, 1}), backend.image, {});
        result.sha256 = sha256Hex(result.exr);
        ended.save(result);
    }
    farm.onIdle = [this] { stop.stop(); };
    runFleet(parts(), {member("a")});
    ASSERT_EQ(farm.uploads.size(), 1u);
    EXPECT_EQ(farm.uploads[0].leaseId, "old");
    EXPECT_EQ(farm.uploads[0].epoch, 3u);
}

}  // namespace
}  // namespace tilefarm
