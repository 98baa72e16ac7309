#include "tests/unit/server/api/api_fixture.h"

namespace tilefarm {
namespace {

class ForecastApi : public ApiTest {
protected:
    json asked(uint32_t samples = 16) { return {{"job", toJson(wanted)}, {"samples", samples}}; }
    std::vector<std::string> faultsOf(const json& body) {
        const auto refused = post("/v1/forecasts", body);
        EXPECT_EQ(refused->status, 400) << refused->body;
        std::vector<std::string> pointers;
        const json problem = parsed(refused);
        for (const json& fault : problem["errors"]) pointers.push_back(fault["pointer"]);
        if (!pointers.empty()) {
            EXPECT_NE(problem["detail"].get<std::string>().find(pointers[0]), std::string::npos) << problem;
        }
        return pointers;
    }

    JobSpec wanted = spec();
};

TEST_F(ForecastApi, RendersAPilotOfFewSamplesAndOneFrame) {
    wanted.name = "film";
    wanted.frames = {3, 40, 2};
    wanted.stop.samples = 5000;
    const auto started = post("/v1/forecasts", asked());
    ASSERT_EQ(started->status, 201) << started->body;
    const std::string pilot = parsed(started)["pilot"];
    EXPECT_EQ(parsed(started)["forecast"], "/v1/jobs/" + pilot + "/forecast?frames=40");
    EXPECT_EQ(started->get_header_value("Location"), parsed(started)["forecast"]);
    const JobSpec made = jobFromJson(parsed(get("/v1/jobs/" + pilot))["spec"]);
    EXPECT_EQ(made.name, "forecast of film");
    EXPECT_EQ(made.frames, (FrameSet{3, 1}));
    EXPECT_EQ(made.stop.samples, 16u);
    EXPECT_GE(made.priority, 90);
    EXPECT_EQ(made.image, wanted.image);
}

TEST_F(ForecastApi, TellsWhatTheJobWouldTake) {
    wanted.stop.relativeError = 0.5;
    const json started = parsed(post("/v1/forecasts", asked(8)));
    const std::string path = started["forecast"];
    EXPECT_NE(path.find("relativeError=0.5"), std::string::npos);
    EXPECT_EQ(parsed(get(path))["basis"], nullptr);
    while (true) {
        const auto work = askForWork();
        if (work->status == 204) break;
        ASSERT_EQ(upload(leaseFromJson(parsed(work)))->status, 200);
    }
    const json view = parsed(get(path));
    EXPECT_EQ(view["basis"]["samples"], 8);
    ASSERT_EQ(view["targets"].size(), 5u);  // the job's own, and the usual ones
    EXPECT_EQ(view["targets"][0]["relativeError"], 0.5);
    EXPECT_EQ(view["targets"][1]["relativeError"], 0.05);
    EXPECT_GT(view["targets"][1]["forecast"]["deviceSeconds"]["value"],
              view["targets"][0]["forecast"]["deviceSeconds"]["value"]);
    EXPECT_EQ(parsed(get("/v1/jobs/" + started["pilot"].get<std::string>() + "/forecast"))["targets"].size(),
              4u);
}

TEST_F(ForecastApi, NamesEveryFaultOfARequest) {
    json body = asked();
    body["job"]["image"]["width"] = 0;
    EXPECT_EQ(faultsOf(body), std::vector<std::string>{"/job/image/width"});
    EXPECT_EQ(faultsOf({{"samples", 3}, {"x", 1}}), (std::vector<std::string>{"/samples", "/x", "/job"}));
    for (const json& samples : {json(-1), json("16"), json(1e9), json(8.5)})
        EXPECT_EQ(faultsOf({{"job", toJson(wanted)}, {"samples", samples}}),
                  std::vector<std::string>{"/samples"});
    EXPECT_EQ(post("/v1/forecasts", json::array())->status, 400);
    EXPECT_EQ(get("/v1/jobs/none/forecast")->status, 404);
    const std::string id = submit()["id"];
    for (const char* bad :
         {"relativeError=", "relativeError=0", "relativeError=0.1,", "relativeError=0.1;0.2",
          "relativeError=nan", "relativeError=-1", "frames=0", "frames=x"})
        EXPECT_EQ(get("/v1/jobs/" + id + "/forecast?" + bad)->status, 400) << bad;
}

}  // namespace
}  // namespace tilefarm
