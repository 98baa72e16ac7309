#include "worker/agent/http_farm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/expect_error.h"
#include "tests/support/fake_farm.h"

namespace tilefarm {
namespace {

TEST(HttpFarm, SaysOfASceneWhatTheApiAsksFor) {
    FakeFarm server;
    PreparedScene scene;
    scene.warnings = {{"KHR_x", "materials/3 (Cloth)", "rendered without"}};
    scene.features = {{"environment"}, {"textures", "volume"}, {}};
    scene.loadSeconds = 0.25;
    scene.times = {0.5, 0.75, 1.0};
    makeHttpFarm(server.url(), "secret")->reportScene("l1", 7, scene);
    ASSERT_EQ(server.seen().size(), 1u);
    EXPECT_EQ(server.seen()[0].path, "/v1/leases/l1/report");
    EXPECT_EQ(server.seen()[0].authorization, "Bearer secret");
    const auto body = nlohmann::json::parse(server.seen()[0].body);
    EXPECT_EQ(body["epoch"], 7);
    EXPECT_EQ(body["warnings"][0]["where"], "materials/3 (Cloth)");
    EXPECT_EQ(body["features"]["leftOut"], (nlohmann::json{"textures", "volume"}));
    EXPECT_EQ(body["prepareSeconds"], 2.5);
}

TEST(HttpFarm, PassesOnWhatTheServerSaysAsTheCodesThatActionsAreMadeFor) {
    FakeFarm server;
    const auto farm = makeHttpFarm(server.url(), "");
    for (const auto& [status, code] : {std::pair{401, ErrorCode::unauthorized},
                                       {409, ErrorCode::conflict},
                                       {410, ErrorCode::gone},
                                       {422, ErrorCode::unprocessable},
                                       {426, ErrorCode::versionRefused},
                                       {429, ErrorCode::tooMany},
                                       {503, ErrorCode::unavailable},
                                       {507, ErrorCode::outOfSpace}}) {
        server.answerAll(status, R"({"detail": "because"})");
        EXPECT_EQ(codeOf([&] { farm->renew("l1", 1); }), code);
        EXPECT_EQ(codeOf([&] { farm->lease({"w", "h", "d", "d", "0.1.0"}, 5); }), code);
    }
}

TEST(HttpFarm, RefusesWhatIsNoUrl) {
    EXPECT_EQ(codeOf([] { makeHttpFarm("farm", ""); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
