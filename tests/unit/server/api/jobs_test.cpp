#include "tests/unit/server/api/api_fixture.h"

namespace tilefarm {
namespace {

TEST_F(ApiTest, StoresABlobOnceAndGivesItBack) {
    const std::string path = "/v1/blobs/" + sha256Hex(std::string_view("bytes"));
    EXPECT_EQ(client.Put(path.c_str(), "bytes", "application/octet-stream")->status, 201);
    EXPECT_EQ(client.Put(path.c_str(), "bytes", "application/octet-stream")->status, 200);
    EXPECT_EQ(client.Put(path.c_str(), "other", "application/octet-stream")->status, 422);
    EXPECT_EQ(client.Put("/v1/blobs/abc", "bytes", "application/octet-stream")->status, 400);
    EXPECT_EQ(get(path)->body, "bytes");
    EXPECT_EQ(get(path, {{"Range", "bytes=1-3"}})->body, "yte");
    EXPECT_EQ(client.Head(path.c_str())->get_header_value("Content-Length"), "5");
    EXPECT_EQ(get("/v1/blobs/" + std::string(64, '0'))->status, 404);
}

TEST_F(ApiTest, NamesTheBlobsThatAreMissing) {
    const std::string here = spec().scene.files.at("a.glb"), absent(64, '1');
    EXPECT_EQ(parsed(post("/v1/blobs/missing", {{"sha256", {here, absent}}}))["missing"], json({absent}));
    const auto bad = post("/v1/blobs/missing", {{"sha256", {here, "x", 3}}});
    EXPECT_EQ(bad->status, 400);
    EXPECT_EQ(parsed(bad)["errors"].size(), 2u);
    EXPECT_EQ(post("/v1/blobs/missing", json::array())->status, 400);
}

TEST_F(ApiTest, MakesAJobAndShowsIt) {
    const auto made = post("/v1/jobs", toJson(spec()));
    ASSERT_EQ(made->status, 201);
    const json view = parsed(made);
    EXPECT_EQ(made->get_header_value("Location"), "/v1/jobs/" + view["id"].get<std::string>());
    EXPECT_EQ(view["state"], "queued");
    EXPECT_EQ(view["createdAt"], "2023-11-14T22:13:20.000Z");
    EXPECT_EQ(view["startedAt"], nullptr);
    EXPECT_EQ(view["progress"]["passes"], 24);
    EXPECT_EQ(view["relativeError"], nullptr);
    EXPECT_EQ(view["relativeErrorInterval"], nullptr);
    EXPECT_EQ(view["errorTail"], nullptr);
    EXPECT_EQ(jobFromJson(view["spec"]), spec());
    EXPECT_EQ(parsed(get("/v1/jobs/" + view["id"].get<std::string>())), view);
    EXPECT_EQ(get("/v1/jobs/none")->status, 404);
}

TEST_F(ApiTest, ShowsAJobWhoseSceneHasFurtherFiles) {
    JobSpec further = spec();
    further.scene.files["sky.hdr"] = further.scene.files.at("a.glb");
    further.scene.environment = "sky.hdr";
    const auto made = post("/v1/jobs", toJson(further));
    ASSERT_EQ(made->status, 201) << made->body;
    EXPECT_EQ(jobFromJson(parsed(made)["spec"]), further);
    EXPECT_EQ(parsed(get("/v1/jobs"))["jobs"].size(), 1u);
}

TEST_F(ApiTest, ListsEveryFaultOfAJobWithItsPlace) {
    json body = toJson(spec());
    body["image"]["width"] = 0;
    body["nonsense"] = 1;
    const auto refused = post("/v1/jobs", body);
    EXPECT_EQ(refused->status, 400);
    std::vector<std::string> pointers;
    const json problem = parsed(refused);
    for (const json& fault : problem["errors"]) pointers.push_back(fault["pointer"]);
    EXPECT_EQ(pointers.size(), 2u);
    EXPECT_NE(std::find(pointers.begin(), pointers.end(), "/image/width"), pointers.end());
    EXPECT_EQ(client.Post("/v1/jobs", "{", "application/json")->status, 400);
}

TEST_F(ApiTest, GivesAJobWithoutASizeThatOfItsCamera) {
    json body = toJson(spec(R"({"cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 2}}],
                                "nodes": [{"camera": 0}]})"));
    body["image"] = {{"tileSize", 16}};
    EXPECT_EQ(parsed(post("/v1/jobs", body))["spec"]["image"],
              json({{"width", 320}, {"height", 640}, {"tileSize", 16}}));
    body["image"]["width"] = 32768;
    body["image"]["tileSize"] = 8;
    const auto refused = post("/v1/jobs?validate=only", body);
    EXPECT_EQ(refused->status, 400) << "of 32768 x 32768 pixels";
    EXPECT_EQ(parsed(refused)["errors"][0]["pointer"], "/image/tileSize");
}

TEST_F(ApiTest, RefusesAJobWhoseFilesAreNotHere) {
    JobSpec job = spec();
    job.scene.files["dir/b~.bin"] = std::string(64, 'b');
    const auto refused = post("/v1/jobs", toJson(job));
    EXPECT_EQ(refused->status, 422);
    EXPECT_EQ(parsed(refused)["errors"][0]["pointer"], "/scene/files/dir~1b~0.bin");
}

TEST_F(ApiTest, RefusesTilesThatWouldFillItsMemory) {
    JobSpec job = spec();
    job.image = {.width = 32768, .height = 1024, .tileSize = 1024};
    const auto refused = post("/v1/jobs", toJson(job));
    EXPECT_EQ(refused->status, 422);
    EXPECT_EQ(parsed(refused)["errors"][0]["pointer"], "/image/tileSize");
}

TEST_F(ApiTest, ValidatesWithoutMakingAJob) {
    const auto valid = post("/v1/jobs?validate=only", toJson(spec()));
    EXPECT_EQ(valid->status, 200);
    EXPECT_EQ(parsed(valid)["valid"], true);
    EXPECT_EQ(parsed(valid)["passes"], 24);
    EXPECT_TRUE(parsed(get("/v1/jobs"))["jobs"].empty());
    EXPECT_EQ(post("/v1/jobs?validate=maybe", toJson(spec()))->status, 400);
}

TEST_F(ApiTest, MakesOneJobForARepeatedRequest) {
    const httplib::Headers key{{"Idempotency-Key", "k"}};
    const auto first = post("/v1/jobs", toJson(spec()), key);
    const auto second = post("/v1/jobs", toJson(spec()), key);
    EXPECT_EQ(first->status, 201);
    EXPECT_EQ(second->status, 200);
    EXPECT_EQ(parsed(first)["id"], parsed(second)["id"]);
    JobSpec other = spec();
    other.priority = 1;
    EXPECT_EQ(post("/v1/jobs", toJson(other), key)->status, 409);
}

TEST_F(ApiTest, PagesThroughJobsNewestFirst) {
    std::vector<std::string> ids;
    for (int i = 0; i < 5; ++i) ids.push_back(submit()["id"]);
    std::vector<std::string> seen;
    std::string path = "/v1/jobs?limit=2";
    for (int pages = 1;; ++pages) {
        const json page = parsed(get(path));
        for (const json& job : page["jobs"]) seen.push_back(job["id"]);
        if (page["next"].is_null()) {
            EXPECT_EQ(pages, 3);
            break;
        }
        path = "/v1/jobs?limit=2&cursor=" + page["next"].get<std::string>();
    }
    std::reverse(ids.begin(), ids.end());
    EXPECT_EQ(seen, ids);
    EXPECT_EQ(parsed(get("/v1/jobs?state=running"))["jobs"].size(), 0u);
}

// A scene may have thousands of files, and a page a thousand jobs.
TEST_F(ApiTest, ListsOfAScenesFilesTheEntryAlone) {
    JobSpec job = spec("one");
    job.scene.files["b.bin"] = spec("two").scene.files.at("a.glb");
    const json made = parsed(post("/v1/jobs", toJson(job)));
    EXPECT_EQ(made["spec"]["scene"]["files"].size(), 2u);
    json listed = parsed(get("/v1/jobs"))["jobs"].at(0);
    EXPECT_EQ(listed["spec"]["scene"]["files"], json({{"a.glb", sha256Hex(std::string_view("one"))}}));
    listed["spec"]["scene"]["files"] = made["spec"]["scene"]["files"];
    EXPECT_EQ(listed, made);
}

TEST_F(ApiTest, MovesJobsAsTheTableAllows) {
    const std::string path = "/v1/jobs/" + submit()["id"].get<std::string>();
    EXPECT_EQ(parsed(client.Post((path + "/pause").c_str()))["state"], "paused");
    EXPECT_EQ(parsed(client.Post((path + "/resume").c_str()))["state"], "queued");
    EXPECT_EQ(parsed(client.Post((path + "/cancel").c_str()))["state"], "canceled");
    EXPECT_EQ(client.Post((path + "/resume").c_str())->status, 409);
    EXPECT_EQ(client.Post("/v1/jobs/none/cancel")->status, 404);
}

TEST_F(ApiTest, GivesEventsAsAListAndAsAStream) {
    const std::string id = submit()["id"];
    const json list = parsed(get("/v1/jobs/" + id + "/events?after=0"));
    ASSERT_EQ(list["events"].size(), 1u);
    EXPECT_EQ(list["events"][0]["data"]["state"], "queued");
    EXPECT_EQ(list["after"], list["events"][0]["id"]);
    EXPECT_TRUE(parsed(get("/v1/events", {{"Accept", "application/json"}}))["events"].size() == 1);

    std::string text;
    client.Get("/v1/events", {{"Last-Event-ID", "0"}, {"Accept", "text/event-stream"}},
               [&](const char* data, size_t size) {
                   text.append(data, size);
                   return text.find("\n\n") == std::string::npos;
               });
    EXPECT_EQ(text.find("id: 1\nevent: job\ndata: {"), 0u);
    EXPECT_EQ(get("/v1/jobs/none/events?after=0")->status, 404);
}

TEST_F(ApiTest, PushesAnEventToWhoeverWaits) {
    std::string text;
    std::thread watcher([&] {
        httplib::Client stream("127.0.0.1", server.port());
        stream.set_read_timeout(30);
        stream.Get("/v1/events", [&](const char* data, size_t size) {
            if (text.empty()) {  // the opening comment: only now is there somebody to tell
                farm.scheduler->submit(spec());
                events.publish();
            }
            text.append(data, size);
            return text.find("event: job") == std::string::npos;
        });
    });
    watcher.join();
    EXPECT_NE(text.find("\"state\":\"queued\""), std::string::npos);
}

}  // namespace
}  // namespace tilefarm
