#include <gmock/gmock.h>

#include "tests/unit/server/api/api_fixture.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

class StudyApiTest : public ApiTest {
protected:
    json request() {
        json study{{"job", toJson(spec())}, {"samples", {2}}, {"seeds", 2}, {"reference", {{"samples", 8}}}};
        study["knobs"] = json::parse(R"([{"path": "settings.clampIndirect", "values": [1]}])");
        return study;
    }
    std::string create() { return parsed(post("/v1/studies", request()))["id"]; }
    void runToTheEnd(const std::string& id) {
        for (int i = 0; i < 100 && parsed(get("/v1/studies/" + id))["finishedAt"].is_null(); ++i) {
            studies.step();
            farm.finish();
        }
    }
};

TEST_F(StudyApiTest, MakesAStudyAndShowsWhatItFound) {
    const auto made = post("/v1/studies", request());
    ASSERT_EQ(made->status, 201) << made->body;
    const std::string id = parsed(made)["id"];
    EXPECT_EQ(made->get_header_value("Location"), "/v1/studies/" + id);
    EXPECT_EQ(parsed(made)["progress"],
              json::parse(R"({"jobs":5,"jobsDone":0,"cells":2,"cellsMeasured":0})"));
    runToTheEnd(id);
    const json view = parsed(get("/v1/studies/" + id));
    EXPECT_EQ(view["state"], "completed") << view["fault"];
    EXPECT_EQ(view["progress"]["jobsDone"], 5);
    EXPECT_TRUE(view["result"]["verdict"].is_string());
    EXPECT_EQ(view["result"]["variants"][1]["settings"]["settings.clampIndirect"], 1);
    const std::string job = view["result"]["variants"][1]["cells"][0]["jobs"][1];
    EXPECT_EQ(parsed(get("/v1/jobs/" + job))["spec"]["settings"]["seed"], 1);
    EXPECT_EQ(parsed(get("/v1/studies"))["studies"][0]["id"], id);
    EXPECT_EQ(parsed(get("/v1/studies?limit=1"))["next"], nullptr);
}

TEST_F(StudyApiTest, GivesTablesAndAPage) {
    const std::string id = create();
    EXPECT_EQ(get("/v1/studies/" + id + "/report.html")->status, 200);  // of what there is so far
    runToTheEnd(id);
    const auto csv = get("/v1/studies/" + id + "/report.csv");
    EXPECT_THAT(csv->get_header_value("Content-Type"), HasSubstr("text/csv"));
    EXPECT_THAT(csv->body, HasSubstr("\"settings.clampIndirect = 1\",2,1.0"));
    const auto page = get("/v1/studies/" + id + "/report.html");
    EXPECT_THAT(page->get_header_value("Content-Type"), HasSubstr("text/html"));
    EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
    EXPECT_THAT(page->body, HasSubstr("data:image/png;base64,"));
}

TEST_F(StudyApiTest, NamesTheFaultsOfARequest) {
    json wrong = request();
    wrong["knobs"][0]["values"] = {1, -2};
    auto answer = post("/v1/studies", wrong);
    EXPECT_EQ(answer->status, 400);
    EXPECT_EQ(parsed(answer)["errors"][0]["pointer"], "/knobs/0/values/1") << answer->body;
    wrong = request();
    wrong["job"]["scene"]["files"]["a.glb"] = std::string(64, 'b');
    answer = post("/v1/studies", wrong);
    EXPECT_EQ(answer->status, 422);
    EXPECT_EQ(parsed(answer)["errors"][0]["pointer"], "/job/scene/files/a.glb") << answer->body;
    EXPECT_EQ(get("/v1/studies/s0")->status, 404);
    EXPECT_EQ(get("/v1/studies/s0/report.csv")->status, 404);
    EXPECT_EQ(post("/v1/studies/s0/cancel", json::object())->status, 404);
}

TEST_F(StudyApiTest, CancelsAStudyOnce) {
    const std::string id = create();
    EXPECT_EQ(parsed(post("/v1/studies/" + id + "/cancel", json::object()))["state"], "canceled");
    studies.step();
    EXPECT_TRUE(parsed(get("/v1/studies/" + id))["finishedAt"].is_string());
    const std::string done = create();
    runToTheEnd(done);
    EXPECT_EQ(post("/v1/studies/" + done + "/cancel", json::object())->status, 409);
}

}  // namespace
}  // namespace tilefarm
